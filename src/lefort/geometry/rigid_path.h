/// \file
/// Where a bone segment is at each moment of its planned path.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>

#include <span>
#include <string>
#include <vector>

namespace lefort::geometry {

/// Where the segment is at one moment: rotated about `center_L`, then translated.
struct Keyframe {
  double at = 1.0;                     ///< Share of the path that is done, 0 to 1.
  Vec3 translation_mm = Vec3::Zero();  ///< In L.
  Vec3 rotation_rad = Vec3::Zero();    ///< Rotation vector (axis times angle) in L.
  Vec3 center_L = Vec3::Zero();        ///< Fixed point of the rotation [mm].
};

/// What a bone does between two keyframes, while it turns steadily.
enum class Interpolation {
  kStraight,  ///< The later keyframe's center moves along a straight line.
  kScrew,     ///< The bone turns about one axis and glides along it; no center takes part.
};

/// The way of one segment, from rest at `at` = 0 through its keyframes.
struct RigidPath {
  std::string segment;
  std::vector<Keyframe> keyframes;  ///< Ascending `at`; the last is at 1.
  int steps = 12;                   ///< Equilibria asked for along the way.
  Interpolation interpolation = Interpolation::kStraight;
};

/// Tells whether a path can be followed.
///
/// \returns nothing, or kPlanInvalid naming the segment and the offending value: no keyframe, `at`
///   not ascending within (0, 1] or not ending at 1, a number that is not finite, a rotation of
///   half a turn or more, by itself or from the keyframe before (its way would be ambiguous),
///   fewer than one step.
[[nodiscard]] Result<void> check_path(const RigidPath& path);

/// The pose of the segment a share of the way along its path.
///
/// Between keyframes the segment turns steadily about one axis by the smaller angle while the later
/// keyframe's center moves along a straight line, or along the screw between them
/// (geometry/rigid_motion.h).
///
/// \param path    passes check_path().
/// \param share   0 to 1; 0 is the segment as scanned, and each keyframe is met exactly.
/// \returns X_LB of the segment.
[[nodiscard]] RigidTransform pose_at(const RigidPath& path, double path_fraction);

/// Of several segments that move together: one pose a path.
[[nodiscard]] std::vector<RigidTransform> poses_at(std::span<const RigidPath> paths,
                                                   double path_fraction);

/// Into how many steps the way of several segments is cut, which all move at once: as many as the
/// path with the most asks for.
/// \param paths  one or more.
[[nodiscard]] int steps_of(std::span<const RigidPath> paths);

/// How far the farthest of some points moves from one moment of the path to another, as the crow
/// flies: what a distance field's band must cover when the solver takes both in one step.
///
/// \param points_B   points of the segment as scanned.
/// \returns [mm]; 0 without points.
[[nodiscard]] double max_displacement_mm(const RigidPath& path, std::span<const Vec3> points_B,
                                         double from_fraction, double to_fraction);

}  // namespace lefort::geometry
