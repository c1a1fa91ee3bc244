/// \file
/// The difference between two faces by region, with the baseline without change.
#pragma once

#include <lefort/compare/difference_statistics.h>
#include <lefort/compare/face_regions.h>
#include <lefort/compare/surface_difference.h>

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lefort::compare {

/// The statistics of one region of the face.
struct RegionDifference {
  std::string region;
  DifferenceStatistics face;
  /// Baseline without change: the difference if the face were as before surgery.
  std::optional<DifferenceStatistics> baseline;
};

/// Assigns vertices to the regions of the face before surgery. If `face_L` is the same surface
/// after a displacement, each vertex keeps the region that it had before.
///
/// \param face_L    the face.
/// \param before_L  the face before surgery; null if there is none.
/// \param regions   of the face before surgery.
/// \returns the region of each vertex of `face_L`.
[[nodiscard]] std::vector<FaceRegion> regions_of(const geometry::TriangleMesh& face_L,
                                                 const geometry::TriangleMesh* before_L,
                                                 const FaceRegions& regions);

/// Computes the statistics of the whole face, of the part that moved, and of the regions.
///
/// Skin that does not move reduces the differences of the whole face. The moved part is therefore
/// reported separately: the points more than 0.5 mm from the face before surgery. The distance is
/// from vertex to vertex if both are the same mesh, otherwise to the closest point.
///
/// \param face_L      the face.
/// \param difference  of `face_L` to `other`.
/// \param other       the face to compare with.
/// \param before_L    the face before surgery; null: no moved part and no baseline.
/// \param regions     of the face before surgery.
/// \returns the parts with a nonzero area of `face_L`, the whole first.
[[nodiscard]] std::vector<RegionDifference> compare_by_region(
    const geometry::TriangleMesh& face_L, const SurfaceDifference& difference,
    const geometry::Bvh& other, const geometry::TriangleMesh* before_L, const FaceRegions& regions);

/// Computes the statistics of the lengths of displacements by region.
///
/// \param before_L         the face before surgery.
/// \param displacement_mm  one per vertex of `before_L`.
/// \param regions          of the face before surgery.
/// \returns as compare_by_region(), without a baseline.
[[nodiscard]] std::vector<RegionDifference> movement_by_region(
    const geometry::TriangleMesh& before_L, std::span<const Vec3> displacement_mm,
    const FaceRegions& regions);

}  // namespace lefort::compare
