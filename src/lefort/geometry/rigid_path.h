/// \file
/// The planned path of a bone segment: its pose at each path fraction.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>

#include <span>
#include <string>
#include <vector>

namespace lefort::geometry {

/// Pose at one path fraction: rotation about `center_L`, then translation.
struct Keyframe {
  double path_fraction = 1.0;          ///< Path fraction, > 0, <= 1.
  Vec3 translation_mm = Vec3::Zero();  ///< In L.
  Vec3 rotation_rad = Vec3::Zero();    ///< Rotation vector (axis times angle) in L.
  Vec3 center_L = Vec3::Zero();        ///< Fixed point of the rotation [mm].
};

/// Motion of a bone between two keyframes; its orientation changes at a constant rate.
enum class Interpolation {
  kStraight,  ///< The center of the later keyframe moves along a straight line.
  /// Screw motion: rotation about one axis and translation along it; centers are not used.
  kScrew,
};

/// The path of one segment, from its scanned pose at path fraction 0 through its keyframes.
struct RigidPath {
  std::string segment;
  std::vector<Keyframe> keyframes;  ///< Ascending `path_fraction`; the last is at 1.
  int steps = 12;                   ///< Equilibria that are computed along the path.
  Interpolation interpolation = Interpolation::kStraight;
};

/// Checks that a path is valid.
///
/// \param path  from the plan.
/// \returns nothing, or kPlanInvalid naming segment and invalid value: no keyframe, fractions
///   not ascending within (0, 1] or not ending at 1, a number that is not finite, a rotation by pi
///   or more, in total or from the previous keyframe (its direction would be ambiguous), fewer than
///   one step.
[[nodiscard]] Result<void> check_path(const RigidPath& path);

/// The pose of the segment at a path fraction.
///
/// Between keyframes the orientation changes at a constant rate about one axis, by the smaller
/// angle. The center of the later keyframe moves along a straight line (kStraight), or the segment
/// follows the screw motion (kScrew; geometry/rigid_motion.h).
///
/// \param path           passes check_path().
/// \param path_fraction  0 to 1; 0 is the scanned pose, and poses at keyframes are exact.
/// \returns X_LB of the segment.
[[nodiscard]] RigidTransform pose_at(const RigidPath& path, double path_fraction);

/// The poses of several segments at the same path fraction, in the order of the paths.
///
/// \param paths          each passes check_path().
/// \param path_fraction  0 to 1.
[[nodiscard]] std::vector<RigidTransform> poses_at(std::span<const RigidPath> paths,
                                                   double path_fraction);

/// Number of steps for several segments that move simultaneously: the maximum over their paths.
///
/// \param paths  one or more.
[[nodiscard]] int steps_of(std::span<const RigidPath> paths);

/// Largest distance between the positions of a point at two path fractions: what the band of a
/// distance field must cover if the solver applies this motion in one step.
///
/// \param path           passes check_path().
/// \param points_B       points of the segment as scanned [mm].
/// \param from_fraction  path fraction of the first position.
/// \param to_fraction    path fraction of the second position.
/// \returns [mm]; 0 without points.
[[nodiscard]] double max_displacement_mm(const RigidPath& path, std::span<const Vec3> points_B,
                                         double from_fraction, double to_fraction);

}  // namespace lefort::geometry
