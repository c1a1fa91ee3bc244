#include <lefort/contact/contact_clearance.h>
#include <lefort/contact/measure_gap.h>

namespace lefort::contact {
namespace {

/// Slack as a fraction of the resolution of the distance query: many times the jumps of a sampled
/// distance between cells.
constexpr double kSlackFraction = 0.2;

}  // namespace

void ContactClearance::record(std::size_t patch, const RigidObstacle& obstacle,
                              std::span<const Vec3> x_L, double clearance_mm) {
  const Mat3 R_BL = obstacle.X_LB.linear().transpose();
  for (std::size_t a = 0; a < x_L.size(); ++a)
    patches_[patch].nodes_B[a] = R_BL * (x_L[a] - obstacle.X_LB.translation());
  patches_[patch].clearance_mm = clearance_mm;
}

bool ContactClearance::is_out_of_range(std::size_t patch, const RigidObstacle& obstacle,
                                       std::span<const Vec3> x_L, double displacement_bound) const {
  const double slack_mm = kSlackFraction * obstacle.distance_query_B->resolution_mm();
  const Patch& last = patches_[patch];
  if (last.clearance_mm <= slack_mm) return false;
  const double allowed_mm = (last.clearance_mm - slack_mm) / (kMaxGapSlope * displacement_bound);
  const Mat3 R_BL = obstacle.X_LB.linear().transpose();
  for (std::size_t a = 0; a < x_L.size(); ++a) {
    const Vec3 x_B = R_BL * (x_L[a] - obstacle.X_LB.translation());
    if (!((x_B - last.nodes_B[a]).squaredNorm() < allowed_mm * allowed_mm)) return false;
  }
  return true;
}

}  // namespace lefort::contact
