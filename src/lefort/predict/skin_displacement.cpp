#include <lefort/predict/skin_displacement.h>

#include <algorithm>

namespace lefort::predict {

SkinDisplacementStatistics measure_skin_displacement(std::span<const Vec3> displacement_mm) {
  constexpr double kMoved_mm = 0.5;
  SkinDisplacementStatistics skin;
  Index moved = 0;
  for (const Vec3& u : displacement_mm) {
    const double length_mm = u.norm();
    skin.max_mm = std::max(skin.max_mm, length_mm);
    if (length_mm <= kMoved_mm) continue;
    skin.mean_over_moved_mm += length_mm;
    ++moved;
  }
  if (moved > 0) skin.mean_over_moved_mm /= double(moved);
  return skin;
}

}  // namespace lefort::predict
