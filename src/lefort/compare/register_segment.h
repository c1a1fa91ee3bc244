/// \file
/// Finds the achieved movement of a segment, from the bone before and after surgery.
#pragma once

#include <lefort/compare/register_surface.h>
#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/geometry/bvh.h>
#include <lefort/geometry/triangle_mesh.h>

namespace lefort::compare {

/// The difference between two movements of the same bone.
struct MovementDifference {
  Vec3 translation_mm;  ///< Of the center of the bone's bounding box, first to second, in L.
  Vec3 rotation_rad;    ///< Rotation vector from the first to the second, in L.
  double max_mm;        ///< Largest distance between the two positions of a vertex.
};

/// \param first_LB, second_LB  the two poses.
/// \param bone_B               not empty.
/// \returns the difference.
[[nodiscard]] MovementDifference difference_of(const RigidTransform& first_LB,
                                               const RigidTransform& second_LB,
                                               const geometry::TriangleMesh& bone_B);

/// Finds the pose of a segment after surgery.
///
/// \param segment_B   the surface of the segment that surgery did not alter: without its cut faces.
/// \param after_L     bone after surgery, registered on the stationary bone.
/// \param planned_LB  the planned pose; used as initial alignment, as is the identity.
/// \param progress    of the registration; may request a stop.
/// \returns the pose, or the errors of register_surface().
[[nodiscard]] Result<Registration> register_segment(const geometry::TriangleMesh& segment_B,
                                                    const geometry::Bvh& after_L,
                                                    const RigidTransform& planned_LB,
                                                    Progress& progress = Progress::none());

/// Removes the part of a bone that surgery may have altered: all triangles near other bone. Saw and
/// healing do not change what remains of stationary bone, so that two scans can be registered on
/// it. What remains of a segment is its surface without cut faces.
///
/// \param bone_L           the bone.
/// \param others_L         the other bones after the osteotomy.
/// \param min_distance_mm  from any of the others.
/// \returns the part of the bone that is further away than that.
[[nodiscard]] geometry::TriangleMesh unaltered_region(
    const geometry::TriangleMesh& bone_L, std::span<const geometry::TriangleMesh> others_L,
    double min_distance_mm);

}  // namespace lefort::compare
