/// \file
/// Which part of the patient's soft tissue takes part in a prediction.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/image/volume.h>
#include <lefort/mesh/cut_surface.h>
#include <lefort/predict/prediction_options.h>

#include <vector>

namespace lefort::predict {

/// So far inside its outermost voxel centers the scan ends: between those values are known.
inline constexpr double kScanEdgeInset_voxels = 0.5;

/// Soft tissue within a box around the moved segment.
struct TissueDomain {
  image::ScalarVolume soft_tissue_level;      ///< anatomy/tissue_levels.h.
  Box3 box_L;                                 ///< The segment's box and the margin around it.
  std::vector<mesh::HalfSpace> cuts_L;        ///< The box's sides: where we cut tissue off.
  std::vector<mesh::HalfSpace> scan_edges_L;  ///< The scan's sides: where the scanner did.

  /// Positive inside [mm]; continuous.
  [[nodiscard]] double level(const Vec3& p_L) const;
  /// Distance to the nearest of `cuts_L`, or of `scan_edges_L` [mm].
  [[nodiscard]] double distance_to_cut(const Vec3& p_L) const;
  [[nodiscard]] double distance_to_scan_edge(const Vec3& p_L) const;
};

/// \param soft_tissue_level  see anatomy/tissue_levels.h.
/// \param scan_grid          of the scan itself.
/// \param segment_L          the bone that moves; several segments as one mesh (plan::append).
[[nodiscard]] TissueDomain make_tissue_domain(image::ScalarVolume soft_tissue_level,
                                              const image::Grid& scan_grid,
                                              const geometry::TriangleMesh& segment_L,
                                              const TissueOptions& options);

}  // namespace lefort::predict
