/// \file
/// Keyframes from surgical input: a pose, target positions of landmarks, or days of distraction.
#pragma once

#include <lefort/core/error.h>
#include <lefort/geometry/rigid_path.h>
#include <lefort/plan/landmarks.h>
#include <lefort/plan/plan.h>

#include <span>
#include <vector>

namespace lefort::plan {

/// \param X_LB      pose of the segment.
/// \param center_L  the point whose path between keyframes is straight [mm].
/// \returns the keyframe of this pose.
[[nodiscard]] geometry::Keyframe keyframe_of_pose(const RigidTransform& X_LB, const Vec3& center_L);

/// Fits a rigid motion that moves landmarks to their targets, by least squares. Its center is the
/// mean of the landmarks.
///
/// \param landmarks     before surgery; those without a target are not used.
/// \param targets       three or more.
/// \param tolerance_mm  max distance of a moved landmark from its target.
/// \returns the keyframe, or kPlanInvalid if
///   - a target has no landmark, or the targets do not determine the motion (see
///     geometry/fit_rigid.h);
///   - a distance exceeds the tolerance (the message names the landmark);
///   - the rotation exceeds 45 degrees, or patient_left_axis() rejects the targets. Both indicate
///     that -R and -L are exchanged. The tolerance alone does not find this, because a rotation can
///     also bring three points to their mirror image.
[[nodiscard]] Result<geometry::Keyframe> keyframe_to_targets(std::span<const Landmark> landmarks,
                                                             std::span<const Landmark> targets,
                                                             double tolerance_mm);

/// Days of activation of a distractor along one direction.
struct DistractionPhase {
  Vec3 towards_L;           ///< Not zero.
  double mm_per_day = 1.0;  ///< > 0.
  int days = 1;             ///< > 0.
};

/// \param phases  one after another.
/// \returns one keyframe at the end of each phase, with path fractions proportional to days; or
///   kPlanInvalid if there is no phase, a member is out of range, or the phases last more than 1000
///   days in total.
[[nodiscard]] Result<std::vector<geometry::Keyframe>> distraction_keyframes(
    std::span<const DistractionPhase> phases);

/// \param phases  accepted by distraction_keyframes().
/// \returns the total number of days.
[[nodiscard]] int total_days(std::span<const DistractionPhase> phases);

}  // namespace lefort::plan
