/// \file
/// Overlap of the bones of a plan along their paths.
#pragma once

#include <lefort/core/error.h>
#include <lefort/field/distance_field.h>
#include <lefort/predict/bone_overlap_at_fraction.h>

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace lefort::predict {

/// A bone whose overlap is measured by trilinear interpolation in its distance field.
///
/// \param name       of the segment, or kRemainder.
/// \param surface_B  closed; must outlive the result.
/// \param path       of the segment, null for the stationary bone; must outlive the result.
/// \param field      of `surface_B`.
/// \returns the bone, or what contact::field_distance_query() returns.
[[nodiscard]] Result<MovingBone> make_moving_bone(
    std::string name, const geometry::TriangleMesh& surface_B, const geometry::RigidPath* path,
    const std::shared_ptr<const field::DistanceField>& field);

/// Overlap of each segment with every later bone at each of `steps` equal steps.
///
/// \param bones  the segments in the order of the plan, then the stationary bone.
/// \param steps  of the path, >= 0.
/// \returns one entry for each step and pair, ordered by step; without depths of the stationary
///   bone's vertices.
[[nodiscard]] std::vector<BoneOverlapAtFraction> path_overlaps(std::span<const MovingBone> bones,
                                                               int steps);

/// \param overlaps  in any order.
/// \returns the deepest overlap, the first of equals; null if no bones overlap.
[[nodiscard]] const BoneOverlapAtFraction* find_deepest(
    std::span<const BoneOverlapAtFraction> overlaps);

/// One sentence on an overlap.
///
/// \param overlap        of two bones.
/// \param segment_count  of the plan; a single segment is not named.
[[nodiscard]] std::string describe_overlap(const BoneOverlapAtFraction& overlap,
                                           std::size_t segment_count);

}  // namespace lefort::predict
