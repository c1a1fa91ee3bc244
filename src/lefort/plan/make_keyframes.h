/// \file
/// Keyframes from what surgeons state: a pose, landmarks and where they shall go, days of
/// distraction.
#pragma once

#include <lefort/core/error.h>
#include <lefort/geometry/rigid_path.h>
#include <lefort/plan/landmarks.h>
#include <lefort/plan/plan.h>

#include <span>
#include <vector>

namespace lefort::plan {

/// The keyframe at which the segment has this pose.
///
/// \param center_L  the point whose way between keyframes is straight [mm].
[[nodiscard]] geometry::Keyframe keyframe_of_pose(const RigidTransform& X_LB, const Vec3& center_L);

/// The keyframe that brings landmarks nearest to their targets, by least squares; its center is the
/// landmarks' mean.
///
/// \param landmarks     where they are before surgery; others than those of `targets` do not count.
/// \param targets       three or more.
/// \param tolerance_mm  how far a landmark may miss its target.
/// \returns kPlanInvalid if a target is of no landmark, they do not fix the motion (see
///   geometry/fit_rigid.h), one is missed by more than the tolerance (the message names it), or the
///   motion turns by more than 45 degrees or the targets' sides contradict L (see
///   patient_left_axis()), as they do if sides are exchanged: three points are met by their mirror
///   image, too.
[[nodiscard]] Result<geometry::Keyframe> keyframe_to_targets(std::span<const Landmark> landmarks,
                                                             std::span<const Landmark> targets,
                                                             double tolerance_mm);

/// Days of distraction along one direction.
struct DistractionPhase {
  Vec3 towards_L;           ///< Not zero.
  double mm_per_day = 1.0;  ///< > 0.
  int days = 1;             ///< > 0.
};

/// One keyframe at the end of each phase, days in proportion to the path.
///
/// \returns kPlanInvalid if there is no phase, one breaks what its members promise, or they last
///   more than 1000 days together.
[[nodiscard]] Result<std::vector<geometry::Keyframe>> distraction_keyframes(
    std::span<const DistractionPhase> phases);

/// All days together, of phases that distraction_keyframes() takes.
[[nodiscard]] int total_days(std::span<const DistractionPhase> phases);

}  // namespace lefort::plan
