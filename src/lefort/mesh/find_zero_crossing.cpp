#include <lefort/mesh/find_zero_crossing.h>

#include <algorithm>

namespace lefort::mesh {

std::optional<double> find_zero_crossing(const Vec3& p, const Vec3& direction,
                                         const InsidePredicate& is_inside, double max_distance_mm,
                                         double tolerance_mm) {
  const bool start = is_inside(p);
  const double side = start ? 1.0 : -1.0;
  const auto is_as_at_start = [&](double distance_mm) {
    return is_inside(p + side * distance_mm * direction) == start;
  };
  double near_mm = 0.0;
  double far_mm = std::min(tolerance_mm, max_distance_mm);
  while (is_as_at_start(far_mm)) {
    if (far_mm >= max_distance_mm) return std::nullopt;
    near_mm = far_mm;
    far_mm = std::min(2.0 * far_mm, max_distance_mm);
  }
  while (far_mm - near_mm > tolerance_mm) {
    const double middle_mm = 0.5 * (near_mm + far_mm);
    (is_as_at_start(middle_mm) ? near_mm : far_mm) = middle_mm;
  }
  return side * 0.5 * (near_mm + far_mm);
}

}  // namespace lefort::mesh
