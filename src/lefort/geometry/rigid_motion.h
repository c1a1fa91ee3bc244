/// \file
/// Rigid poses as surgeons state them, turned about a center, then shifted; and the way between.
#pragma once

#include <lefort/core/types.h>

namespace lefort::geometry {

/// The pose that turns a bone about a fixed center, then shifts it.
///
/// \param translation_mm   shift after the rotation, in L.
/// \param rotation_rad     rotation vector (unit axis times angle), in L; zero is no rotation.
/// \param center_L         the point that the rotation leaves where it is [mm].
/// \returns X_LB, with X_LB * center_L = center_L + translation_mm.
[[nodiscard]] RigidTransform rigid_motion(const Vec3& translation_mm, const Vec3& rotation_rad,
                                          const Vec3& center_L);

/// The rotation vector (unit axis times angle, 0 to pi) of a rotation matrix.
[[nodiscard]] Vec3 rotation_vector(const Mat3& rotation);

/// The pose a share of the way from one pose to another.
///
/// The orientation turns steadily about one axis by the smaller angle; meanwhile the point
/// `center_B` of the bone moves steadily along a straight line.
///
/// \param share      0 gives `from_LB`, 1 gives `to_LB`; values outside continue the motion.
/// \param center_B   any point, in the bone's frame [mm].
/// \note Half a turn has two shortest ways; one of them is taken.
[[nodiscard]] RigidTransform interpolate_pose(const RigidTransform& from_LB,
                                              const RigidTransform& to_LB, double fraction,
                                              const Vec3& center_B);

/// The pose a share of the way along the screw from one pose to another: the bone turns steadily
/// about one axis fixed in L and glides steadily along it (Chasles), by the smaller angle. Needs no
/// center; without a turn it is a straight shift.
///
/// \param share  0 gives `from_LB`, 1 gives `to_LB`; values outside continue the motion.
/// \note Half a turn has two shortest ways; one of them is taken.
[[nodiscard]] RigidTransform interpolate_screw(const RigidTransform& from_LB,
                                               const RigidTransform& to_LB, double fraction);

}  // namespace lefort::geometry
