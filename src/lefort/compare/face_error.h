/// \file
/// The error of a predicted face, by region.
#pragma once

#include <lefort/compare/difference_statistics.h>
#include <lefort/compare/face_regions.h>
#include <lefort/geometry/bvh.h>
#include <lefort/geometry/triangle_mesh.h>

#include <array>
#include <span>
#include <string>
#include <vector>

namespace lefort::compare {

/// A region, or several regions as one.
struct ReportedRegion {
  const char* name;
  std::array<bool, kFaceRegions.size() + 1> contains;  ///< By FaceRegion.
};

/// "face": all regions; "lower face": lips and chin; then each of kFaceRegions.
[[nodiscard]] std::span<const ReportedRegion> reported_regions();

/// The error of one region.
struct RegionError {
  std::string region;
  DifferenceStatistics statistics;
  /// Mean, weighted by area, of the vector from the closest point of the achieved face to the
  /// compared point of the other face, in L; NaN if nothing is compared.
  Vec3 mean_offset_mm;
};

/// Compares a face with the achieved face in each of reported_regions().
///
/// \param face_L      the predicted face, or the face before surgery.
/// \param region_of   one per vertex of `face_L`.
/// \param achieved_L  the face after surgery; closed or open.
/// \returns one row per region.
[[nodiscard]] std::vector<RegionError> face_error(const geometry::TriangleMesh& face_L,
                                                  std::span<const FaceRegion> region_of,
                                                  const geometry::Bvh& achieved_L);

/// As above, from a difference that was already measured.
///
/// \param difference  of the face to the achieved face.
/// \param region_of   one per vertex of the face.
[[nodiscard]] std::vector<RegionError> face_error(const SurfaceDifference& difference,
                                                  std::span<const FaceRegion> region_of);

}  // namespace lefort::compare
