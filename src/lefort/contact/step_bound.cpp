#include <lefort/contact/measure_gap.h>
#include <lefort/contact/step_bound.h>

#include <algorithm>
#include <optional>

namespace lefort::contact {
namespace {

constexpr double kCosMaxTurn = -0.5;
constexpr double kMinStep = 0.5;  ///< Of the resolution.
constexpr int kMinSteps = 4;      ///< In a line that is checked.

}  // namespace

double allowed_fraction(const RigidObstacle& obstacle, const Vec3& from_L, const Vec3& step_L) {
  const double length_mm = step_L.norm();
  const Gap start = measure_gap(obstacle, from_L, Derivatives::kFirst);
  if (!(length_mm > 0.0) || start.gap_mm > kMaxGapSlope * length_mm) return 1.0;
  const double min_step_mm =
      std::min(kMinStep * obstacle.distance_query_B->resolution_mm(), length_mm / kMinSteps);
  std::optional<Vec3> entered_L;
  double along_mm = 0.0, last_mm = 0.0;
  for (;;) {
    const Gap gap =
        measure_gap(obstacle, from_L + along_mm / length_mm * step_L, Derivatives::kFirst);
    const bool is_inside = gap.zone == field::Zone::kInside || gap.gap_mm < 0.0;
    if (!is_inside) entered_L.reset();
    if (is_inside && gap.zone == field::Zone::kBand) {
      if (!entered_L) entered_L = gap.gradient_L;
      if (gap.gradient_L.dot(*entered_L) < kCosMaxTurn * gap.gradient_L.norm() * entered_L->norm())
        return std::max(last_mm, 0.5 * min_step_mm) / length_mm;
    }
    if (along_mm >= length_mm) return 1.0;
    last_mm = along_mm;
    const double step_mm = is_inside ? min_step_mm : gap.gap_mm / kMaxGapSlope;
    along_mm = std::min(along_mm + std::max(step_mm, min_step_mm), length_mm);
  }
}

}  // namespace lefort::contact
