/// \file
/// Rigid motions as surgeons define them (rotation about a center, then translation), and
/// interpolation between poses.
#pragma once

#include <lefort/core/types.h>

namespace lefort::geometry {

/// The pose that rotates a bone about a fixed center, then translates it.
///
/// \param translation_mm  translation after the rotation, in L.
/// \param rotation_rad    rotation vector (unit axis times angle), in L; zero is no rotation.
/// \param center_L        fixed point of the rotation [mm].
/// \returns X_LB, with X_LB * center_L = center_L + translation_mm.
[[nodiscard]] RigidTransform rigid_motion(const Vec3& translation_mm, const Vec3& rotation_rad,
                                          const Vec3& center_L);

/// The rotation vector (unit axis times angle, 0 to pi) of a rotation matrix.
[[nodiscard]] Vec3 rotation_vector(const Mat3& rotation);

/// The pose at a fraction of the motion from one pose to another.
///
/// The orientation changes at a constant rate about one axis, by the smaller angle, while the point
/// `center_B` of the bone moves at constant speed along a straight line.
///
/// \param from_LB   pose at fraction 0.
/// \param to_LB     pose at fraction 1.
/// \param fraction  values outside [0, 1] extrapolate the motion.
/// \param center_B  any point, in the frame of the bone [mm].
/// \note A rotation by pi has two shortest paths; one of them is taken.
[[nodiscard]] RigidTransform interpolate_pose(const RigidTransform& from_LB,
                                              const RigidTransform& to_LB, double fraction,
                                              const Vec3& center_B);

/// The pose at a fraction of the screw motion from one pose to another: the bone rotates at a
/// constant rate about one axis fixed in L and translates along it (Chasles), by the smaller angle.
/// Needs no center; without rotation it is a translation.
///
/// \param from_LB   pose at fraction 0.
/// \param to_LB     pose at fraction 1.
/// \param fraction  values outside [0, 1] extrapolate the motion.
/// \note A rotation by pi has two shortest paths; one of them is taken.
[[nodiscard]] RigidTransform interpolate_screw(const RigidTransform& from_LB,
                                               const RigidTransform& to_LB, double fraction);

}  // namespace lefort::geometry
