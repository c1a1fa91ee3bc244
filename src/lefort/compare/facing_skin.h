/// \file
/// The skin that faces a segment, and how both move.
#pragma once

#include <lefort/geometry/bvh.h>
#include <lefort/geometry/triangle_mesh.h>

#include <span>

namespace lefort::compare {

/// Means over the part of a segment's anterior surface that has skin anterior to it.
struct FacingMovement {
  double area_mm2 = 0.0;         ///< Projected along the direction; 0: there is no such part.
  Vec3 bone_mm = Vec3::Zero();   ///< Mean displacement of that surface of the segment, in L.
  Vec3 skin_mm = Vec3::Zero();   ///< Mean displacement of the skin anterior to it, in L.
  Vec3 center_L = Vec3::Zero();  ///< Mean position of that surface before it moves [mm].
};

/// The anterior surface: triangles of the segment whose normal is within 60 degrees of the
/// direction and that are not hidden by another part of the segment. From the center of each, a ray
/// in that direction leaves the head through the skin; the last exit within 40 mm counts, because
/// the ray may pass through the mouth. Each triangle is weighted by its area projected along the
/// direction.
///
/// \param segment_L        closed, counter-clockwise seen from outside.
/// \param X_LB             pose of the segment after its movement.
/// \param skin_L           the skin before surgery.
/// \param displacement_mm  one per vertex of the skin.
/// \param anterior_L       unit vector.
/// \returns the means.
[[nodiscard]] FacingMovement facing_movement(const geometry::TriangleMesh& segment_L,
                                             const RigidTransform& X_LB,
                                             const geometry::Bvh& skin_L,
                                             std::span<const Vec3> displacement_mm,
                                             const Vec3& anterior_L);

}  // namespace lefort::compare
