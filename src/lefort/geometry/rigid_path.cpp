#include <lefort/core/check.h>
#include <lefort/geometry/rigid_motion.h>
#include <lefort/geometry/rigid_path.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lefort::geometry {
namespace {

RigidTransform pose_of(const Keyframe& key) {
  return rigid_motion(key.translation_mm, key.rotation_rad, key.center_L);
}

/// The error of a single keyframe; empty if it is valid.
std::string complaint_about(const Keyframe& key) {
  if (!key.translation_mm.allFinite()) return "its translation is not a finite vector";
  if (!key.rotation_rad.allFinite()) return "its rotation is not a finite vector";
  if (!key.center_L.allFinite()) return "its center is not a finite point";
  if (!(key.path_fraction > 0.0 && key.path_fraction <= 1.0))
    return fmt::format("`path_fraction` is {}, must be above 0 and at most 1", key.path_fraction);
  if (key.rotation_rad.norm() >= std::numbers::pi)
    return fmt::format("its rotation is {:.4g} rad, must be below half a turn",
                       key.rotation_rad.norm());
  return {};
}

}  // namespace

Result<void> check_path(const RigidPath& path) {
  const auto bad = [&](const std::string& what) {
    return fail(ErrorCode::kPlanInvalid, fmt::format("path of '{}': {}", path.segment, what));
  };
  if (path.steps < 1) return bad(fmt::format("`steps` is {}, must be at least 1", path.steps));
  if (path.keyframes.empty()) return bad("`keyframes` is empty, must have one or more");
  // Closer to pi, rounding would decide the direction of the rotation.
  constexpr double kMaxAngleBetweenKeyframes_rad = std::numbers::pi - 1e-6;
  double before = 0.0;
  Mat3 R_before = Mat3::Identity();
  for (std::size_t k = 0; k < path.keyframes.size(); ++k) {
    const Keyframe& key = path.keyframes[k];
    if (const std::string complaint = complaint_about(key); !complaint.empty())
      return bad(fmt::format("keyframe {}: {}", k, complaint));
    if (key.path_fraction <= before)
      return bad(fmt::format("keyframe {}: `path_fraction` is {}, must be above {}", k,
                             key.path_fraction, before));
    before = key.path_fraction;
    const Mat3 R_key = pose_of(key).linear();
    const double angle_rad = rotation_vector(R_key * R_before.transpose()).norm();
    if (angle_rad > kMaxAngleBetweenKeyframes_rad)
      return bad(
          fmt::format("keyframe {}: half a turn from the previous one, so its direction is "
                      "ambiguous; add a keyframe between them",
                      k));
    R_before = R_key;
  }
  if (before != 1.0) return bad(fmt::format("the last keyframe is at {}, must be at 1", before));
  return {};
}

RigidTransform pose_at(const RigidPath& path, double path_fraction) {
  LEFORT_CHECK(path_fraction >= 0.0 && path_fraction <= 1.0);
  RigidTransform X_before = RigidTransform::Identity();
  double at_before = 0.0;
  for (const Keyframe& key : path.keyframes) {
    const RigidTransform X_key = pose_of(key);
    if (path_fraction == key.path_fraction) return X_key;
    if (path_fraction < key.path_fraction) {
      const double part = (path_fraction - at_before) / (key.path_fraction - at_before);
      return path.interpolation == Interpolation::kScrew
                 ? interpolate_screw(X_before, X_key, part)
                 : interpolate_pose(X_before, X_key, part, key.center_L);
    }
    X_before = X_key;
    at_before = key.path_fraction;
  }
  return X_before;
}

std::vector<RigidTransform> poses_at(std::span<const RigidPath> paths, double path_fraction) {
  std::vector<RigidTransform> poses;
  for (const RigidPath& path : paths) poses.push_back(pose_at(path, path_fraction));
  return poses;
}

int steps_of(std::span<const RigidPath> paths) {
  LEFORT_CHECK(!paths.empty());
  int steps = 1;
  for (const RigidPath& path : paths) steps = std::max(steps, path.steps);
  return steps;
}

double max_displacement_mm(const RigidPath& path, std::span<const Vec3> points_B,
                           double from_fraction, double to_fraction) {
  const RigidTransform X_from = pose_at(path, from_fraction);
  const RigidTransform X_to = pose_at(path, to_fraction);
  double max_mm = 0.0;
  for (const Vec3& p_B : points_B) max_mm = std::max(max_mm, (X_to * p_B - X_from * p_B).norm());
  return max_mm;
}

}  // namespace lefort::geometry
