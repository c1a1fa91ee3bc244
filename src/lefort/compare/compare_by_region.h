/// \file
/// The difference between two faces, part by part, beside "nothing changed".
#pragma once

#include <lefort/compare/difference_statistics.h>
#include <lefort/compare/face_regions.h>
#include <lefort/compare/surface_difference.h>

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lefort::compare {

/// One part of the face and its figures.
struct RegionDifference {
  std::string region;
  DifferenceStatistics face;
  std::optional<DifferenceStatistics> if_unchanged;  ///< Of the face before surgery, likewise.
};

/// The region of each vertex. Landmarks are of the face before surgery: where `face_L` is that face
/// at another moment, skin stays in its region wherever it goes.
///
/// \param before_L  null if there is none.
[[nodiscard]] std::vector<FaceRegion> regions_of(const geometry::TriangleMesh& face_L,
                                                 const geometry::TriangleMesh* before_L,
                                                 const FaceRegions& regions);

/// Figures for the whole face, the part that moved, and the regions that landmarks tell.
///
/// Whole-face figures are flattered by skin that never moves, so the moved part stands apart: what
/// lies more than 0.5 mm from the face before surgery; vertex from vertex if both are one surface
/// at two moments, else from the nearest point.
///
/// \param difference  of `face_L` to `other`.
/// \param before_L    the face before surgery; null: then there is neither moved part nor baseline.
/// \returns parts that `face_L` has any area in, the whole first.
[[nodiscard]] std::vector<RegionDifference> compare_by_region(
    const geometry::TriangleMesh& face_L, const SurfaceDifference& difference,
    const geometry::Bvh& other, const geometry::TriangleMesh* before_L, const FaceRegions& regions);

/// How far each part of a face moved, vertex from vertex: figures of the lengths of displacements.
///
/// \param displacement_mm  one per vertex of `before_L`.
/// \returns as compare_by_region(), without a baseline.
[[nodiscard]] std::vector<RegionDifference> movement_by_region(
    const geometry::TriangleMesh& before_L, std::span<const Vec3> displacement_mm,
    const FaceRegions& regions);

}  // namespace lefort::compare
