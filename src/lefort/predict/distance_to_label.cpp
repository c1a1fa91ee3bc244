#include <lefort/image/visit_voxels_near.h>
#include <lefort/predict/distance_to_label.h>

#include <algorithm>
#include <limits>

namespace lefort::predict {

double distance_to_label(const anatomy::LabelMap& labels, anatomy::Tissue tissue, const Vec3& p_L,
                         double within_mm) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const Vec3 p_V = labels.grid.index_V(p_L);
  double nearest_mm = kNone;
  image::visit_voxels_near(labels.grid, p_L, within_mm, [&](Index i, Index j, Index k) {
    if (labels.at(i, j, k) != tissue) return;
    const Vec3 beyond_V =
        ((p_V - Vec3(double(i), double(j), double(k))).cwiseAbs().array() - 0.5).cwiseMax(0.0);
    nearest_mm = std::min(nearest_mm, beyond_V.cwiseProduct(labels.grid.spacing_mm).norm());
  });
  return nearest_mm <= within_mm ? nearest_mm : kNone;
}

}  // namespace lefort::predict
