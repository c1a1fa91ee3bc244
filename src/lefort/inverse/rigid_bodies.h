/// \file
/// The variables of inverse planning: six numbers of the motion of each rigid body. A body is one
/// segment, or several that keep their relative pose (occlusion).
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/geometry/motion_rates.h>
#include <lefort/geometry/rigid_motion.h>
#include <lefort/geometry/rigid_path.h>
#include <lefort/predict/face_response.h>

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace lefort::inverse {

/// The six numbers of a motion, in the order of their names, as in the planner. Translations are
/// those of the center of rotation: to the patient's left, to anterior, to superior [mm]. Rotations
/// are components of the rotation vector [degrees]: pitch raises the front, roll raises the left
/// side, yaw turns the front to the left. rotation_deg of plan files is (-pitch, -roll, yaw).
inline constexpr std::array<const char*, 6> kMotionNames{"left",  "anterior", "superior",
                                                         "pitch", "roll",     "yaw"};
using MotionVector = Eigen::Matrix<double, 6, 1>;

/// \returns the motion about a center as a keyframe.
[[nodiscard]] geometry::Keyframe keyframe_of(const MotionVector& motion, const Vec3& center_L);
/// \returns the six numbers of a pose about a center.
[[nodiscard]] MotionVector motion_of(const RigidTransform& X_LB, const Vec3& center_L);

struct RigidBody {
  std::string name;
  std::vector<std::size_t> segments;  ///< In the order of the plan; the first moves by `motion`.
  /// X_LB of each segment = X_LB of the first times this; the first is the identity.
  std::vector<RigidTransform> relative;
  Vec3 center_L = Vec3::Zero();  ///< Of the rotation of the first segment [mm].
  MotionVector start = MotionVector::Zero();
  std::array<bool, 6> is_free{true, true, true, true, true, true};
  MotionVector lower = MotionVector::Constant(-20.0);
  MotionVector upper = MotionVector::Constant(20.0);
};

/// Free numbers of all bodies as one vector x, in the order of bodies and names.
class MotionVariables {
 public:
  /// \returns kInvalidArgument, naming the body, if no number is free, a lower bound exceeds an
  ///   upper one, a number that is not free lies outside its bounds, or a number is not finite.
  [[nodiscard]] static Result<MotionVariables> create(std::vector<RigidBody> bodies,
                                                      std::size_t segment_count);

  [[nodiscard]] Index count() const { return Index(numbers_.size()); }
  /// \returns "maxilla anterior".
  [[nodiscard]] std::string name(Index number) const;
  /// \returns "mm" or "deg".
  [[nodiscard]] const char* unit(Index number) const;
  /// \returns the start, moved into the bounds.
  [[nodiscard]] const VectorX& start() const { return start_; }
  [[nodiscard]] const VectorX& lower() const { return lower_; }
  [[nodiscard]] const VectorX& upper() const { return upper_; }

  /// \returns the motion of each body.
  [[nodiscard]] std::vector<MotionVector> motions(const VectorX& x) const;
  /// \returns the pose of each segment.
  [[nodiscard]] std::vector<RigidTransform> poses(const VectorX& x) const;
  /// \returns the motions of the segments by each number, per mm and per degree.
  [[nodiscard]] std::vector<predict::PoseRate> rates(const VectorX& x) const;

  [[nodiscard]] const std::vector<RigidBody>& bodies() const { return bodies_; }

 private:
  MotionVariables() = default;

  std::vector<RigidBody> bodies_;
  std::size_t segment_count_ = 0;
  std::vector<std::pair<std::size_t, Index>> numbers_;  ///< Body and component of each.
  VectorX start_, lower_, upper_;
};

}  // namespace lefort::inverse
