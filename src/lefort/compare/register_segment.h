/// \file
/// What movement of a bone was achieved, from the bone before and the skull after surgery.
#pragma once

#include <lefort/compare/register_surface.h>
#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/geometry/bvh.h>
#include <lefort/geometry/triangle_mesh.h>

namespace lefort::compare {

/// One movement beside another of the same bone.
struct MovementDifference {
  Vec3 translation_mm;  ///< Of the bone's center, from the first to the second, in L.
  Vec3 rotation_rad;    ///< Rotation vector from the first to the second, in L.
  double max_mm;        ///< Of the distances between where the two bring a vertex.
};

/// \param bone_B  not empty.
[[nodiscard]] MovementDifference difference_of(const RigidTransform& first_LB,
                                               const RigidTransform& second_LB,
                                               const geometry::TriangleMesh& bone_B);

/// Finds where a segment went.
///
/// \param segment_B   what of the segment is as it was before surgery: without its cut faces.
/// \param after_L     bone after surgery, registered on what did not move.
/// \param planned_LB  where it should have gone: tried as a start beside no movement.
/// \returns the pose, or what register_surface() returns.
[[nodiscard]] Result<Registration> register_segment(const geometry::TriangleMesh& segment_B,
                                                    const geometry::Bvh& after_L,
                                                    const RigidTransform& planned_LB,
                                                    Progress& progress = Progress::none());

/// The part of a bone that lies further than `min_distance_mm` from every other: of the still bone
/// what saw and healing left alone, by which two scans are registered; of a segment what was not
/// cut.
[[nodiscard]] geometry::TriangleMesh unaltered_region(
    const geometry::TriangleMesh& bone_L, std::span<const geometry::TriangleMesh> others_L,
    double min_distance_mm);

}  // namespace lefort::compare
