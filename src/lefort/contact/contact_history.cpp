#include <lefort/contact/contact_history.h>
#include <lefort/core/check.h>

#include <algorithm>

namespace lefort::contact {
namespace {

/// Constants of the adaptive penalty, \cite bertsekas1982, section 2.2: gamma, beta, and a bound
/// that keeps the tangent well conditioned. The values are ours; the study "contact on a real
/// head", section "Penalty stiffness", measures the effect.
constexpr double kRequiredReduction = 0.5;  ///< Of the depth, by one update.
constexpr double kPenaltyGrowth = 4.0;
constexpr double kMaxPenaltyScale = 64.0;

}  // namespace

bool ContactHistory::has_tunneled(std::size_t point, const RigidObstacle& obstacle,
                                  const Gap& measured) const {
  const Point& at = points_[point];
  return !at.now.is_plane_constrained && !at.crossed_medial_surface &&
         is_at_far_side(obstacle, measured, at.reference);
}

bool ContactHistory::commit(std::size_t point, const RigidObstacle& obstacle, const Vec3& p_L,
                            const Gap& measured) {
  Point& at = points_[point];
  const bool crossed_medial_surface =
      uses_tangent_planes_ && has_crossed_medial_surface(obstacle, p_L, measured, at.reference);
  const bool tunneled = !crossed_medial_surface && has_tunneled(point, obstacle, measured);
  at.committed = at.now;
  at.crossed_medial_surface = crossed_medial_surface;
  at.has_returned =
      at.now.is_plane_constrained && contact::has_returned(obstacle, p_L, measured, at.reference);
  if (!at.now.is_plane_constrained && !crossed_medial_surface)
    at.reference = contact_reference(obstacle, p_L, measured);
  return tunneled;
}

bool ContactHistory::activate_tangent_plane(std::size_t point, const RigidObstacle& obstacle,
                                            const Vec3& p_L, const Gap& measured) {
  Point& at = points_[point];
  if (at.now.is_plane_constrained ||
      !has_crossed_medial_surface(obstacle, p_L, measured, at.reference))
    return false;
  at.now.is_plane_constrained = true;
  return true;
}

bool ContactHistory::update_multiplier(std::size_t point, double pressure_mpa, double depth_mm,
                                       double tolerance_mm) {
  State& now = points_[point].now;
  now.multiplier_mpa = pressure_mpa;
  if (!(now.multiplier_mpa > 0.0))
    now.penalty_scale = 1.0;
  else if (depth_mm > tolerance_mm && depth_mm > kRequiredReduction * now.previous_depth_mm)
    now.penalty_scale = std::min(kPenaltyGrowth * now.penalty_scale, kMaxPenaltyScale);
  now.previous_depth_mm = depth_mm;
  return now.multiplier_mpa > 0.0;
}

void ContactHistory::rollback() {
  for (Point& point : points_) point.now = point.committed;
}

void ContactHistory::begin_step() {
  for (Point& point : points_)
    point.now = {
        .multiplier_mpa = point.committed.multiplier_mpa,
        .is_plane_constrained = point.committed.is_plane_constrained && !point.has_returned,
        .penalty_scale = point.committed.penalty_scale};
}

ContactCheckpoint ContactHistory::checkpoint() const {
  ContactCheckpoint checkpoint{.multipliers_mpa = {},
                               .penalty_scales = {},
                               .tangent_planes = {},
                               .tunneled_area_mm2 = tunneled_area_mm2_};
  for (const Point& point : points_) {
    checkpoint.multipliers_mpa.push_back(point.committed.multiplier_mpa);
    checkpoint.penalty_scales.push_back(point.committed.penalty_scale);
    checkpoint.tangent_planes.push_back(
        {.foot_B = point.reference.foot_B,
         .normal_B = point.reference.normal_B,
         .is_plane_constrained = point.committed.is_plane_constrained});
  }
  return checkpoint;
}

void ContactHistory::restore(const ContactCheckpoint& checkpoint) {
  LEFORT_CHECK(checkpoint.multipliers_mpa.size() == points_.size());
  LEFORT_CHECK(checkpoint.penalty_scales.size() == points_.size());
  LEFORT_CHECK(checkpoint.tangent_planes.size() == points_.size());
  for (std::size_t k = 0; k < points_.size(); ++k) {
    const ContactCheckpoint::TangentPlane& plane = checkpoint.tangent_planes[k];
    points_[k].now = {.multiplier_mpa = checkpoint.multipliers_mpa[k],
                      .is_plane_constrained = plane.is_plane_constrained,
                      .penalty_scale = checkpoint.penalty_scales[k]};
    points_[k].reference = {plane.foot_B, plane.normal_B, true};
  }
}

}  // namespace lefort::contact
