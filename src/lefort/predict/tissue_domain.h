/// \file
/// The region of soft tissue that a prediction computes.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/image/volume.h>
#include <lefort/mesh/cut_surface.h>
#include <lefort/predict/prediction_options.h>

#include <vector>

namespace lefort::predict {

/// The scan boundary lies this far inside the outermost voxel centers, where values can be
/// interpolated.
inline constexpr double kScanBoundaryInset_voxels = 0.5;

/// Soft tissue in a box around the mobilized segment.
struct TissueDomain {
  image::ScalarVolume soft_tissue_level;           ///< anatomy/tissue_levels.h.
  Box3 box_L;                                      ///< Box of the segments with the margin.
  std::vector<mesh::HalfSpace> cuts_L;             ///< Sides of the box.
  std::vector<mesh::HalfSpace> scan_boundaries_L;  ///< Sides of the scan.

  /// Level-set function of the domain: positive inside [mm], continuous.
  [[nodiscard]] double level(const Vec3& p_L) const;
  /// Distance to the closest plane of `cuts_L` [mm].
  [[nodiscard]] double distance_to_cut(const Vec3& p_L) const;
  /// Distance to the closest plane of `scan_boundaries_L` [mm].
  [[nodiscard]] double distance_to_scan_boundary(const Vec3& p_L) const;
  /// Inward normals of the planes of both kinds within `tolerance_mm` of the point, unit length.
  [[nodiscard]] std::vector<Vec3> planes_at(const Vec3& p_L, double tolerance_mm) const;
};

/// \param soft_tissue_level  see anatomy/tissue_levels.h.
/// \param scan_grid          of the scan; the grid of `soft_tissue_level` may be larger.
/// \param segment_L          the segments as one mesh (plan::append).
/// \param options            its margin is used.
[[nodiscard]] TissueDomain make_tissue_domain(image::ScalarVolume soft_tissue_level,
                                              const image::Grid& scan_grid,
                                              const geometry::TriangleMesh& segment_L,
                                              const TissueOptions& options);

}  // namespace lefort::predict
