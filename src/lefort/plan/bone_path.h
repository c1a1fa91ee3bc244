/// \file
/// Where a bone segment is at each moment of its planned path.
#pragma once

#include <lefort/core/error.h>
#include <lefort/plan/plan.h>

#include <span>
#include <vector>

namespace lefort::plan {

/// Tells whether a path can be followed.
///
/// \returns nothing, or kPlanInvalid naming the segment and the offending value: no keyframe, `at`
///   not ascending within (0, 1] or not ending at 1, a number that is not finite, a rotation of
///   half a turn or more, by itself or from the keyframe before (its way would be ambiguous),
///   fewer than one step.
[[nodiscard]] Result<void> check_path(const BonePath& path);

/// The pose of the segment a share of the way along its path.
///
/// Between keyframes the segment turns steadily about one axis by the smaller angle while the later
/// keyframe's centre moves along a straight line, or along the screw between them
/// (geometry/rigid_motion.h).
///
/// \param path    passes check_path().
/// \param share   0 to 1; 0 is the segment as scanned, and each keyframe is met exactly.
/// \returns X_LB of the segment.
[[nodiscard]] RigidTransform pose_at(const BonePath& path, double share);

/// Of several segments that move together: one pose a path.
[[nodiscard]] std::vector<RigidTransform> poses_at(std::span<const BonePath> paths, double share);

/// Into how many steps the way of several segments is cut, which all move at once: as many as the
/// path with the most asks for.
/// \param paths  one or more.
[[nodiscard]] int steps_of(std::span<const BonePath> paths);

/// How far the farthest of some points moves from one moment of the path to another, as the crow
/// flies: what a distance field's band must cover when the solver takes both in one step.
///
/// \param points_B   points of the segment as scanned.
/// \returns [mm]; 0 without points.
[[nodiscard]] double largest_displacement_mm(const BonePath& path, std::span<const Vec3> points_B,
                                             double from_share, double to_share);

}  // namespace lefort::plan
