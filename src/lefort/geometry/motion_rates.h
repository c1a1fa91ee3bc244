/// \file
/// Derivatives of rigid motions by their numbers.
#pragma once

#include <lefort/core/types.h>

#include <array>

namespace lefort::geometry {

/// Velocity field of a rigid body: the derivative of the position of its points by one number.
struct MotionRate {
  Vec3 translation = Vec3::Zero();  ///< Of the point at `at_L` [mm per unit of the number].
  Vec3 rotation_rad = Vec3::Zero();
  Vec3 at_L = Vec3::Zero();  ///< [mm]

  /// \returns the derivative of the position of the point of the body that is now at `p_L`.
  [[nodiscard]] Vec3 at(const Vec3& p_L) const {
    return translation + rotation_rad.cross(p_L - at_L);
  }
};

/// The derivatives of the positions of rigid_motion() by its six numbers: translation (per mm),
/// then rotation vector (per rad). A change of the rotation vector turns the body about
/// J_l(rotation) times the change, with the left Jacobian of the rotation group (\cite barfoot2017,
/// equation (7.77)):
///
///   J_l = I + (1 - cos a) / a^2 [r] + (a - sin a) / a^3 [r]^2,  a = |r|, [r] p = r x p
[[nodiscard]] std::array<MotionRate, 6> motion_rates(const Vec3& translation_mm,
                                                     const Vec3& rotation_rad,
                                                     const Vec3& center_L);

}  // namespace lefort::geometry
