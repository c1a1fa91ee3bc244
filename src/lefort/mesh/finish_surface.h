/// \file
/// Postprocessing of an isosurface: smoothing, decimation, and a report of defects.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/geometry/triangle_mesh.h>

#include <optional>

namespace lefort::mesh {

struct SurfaceFinish {
  int smoothing_passes = 10;         ///< geometry/smooth_surface.h; 0: none.
  std::optional<Index> triangles{};  ///< Max number of triangles; none: no decimation.
};

/// A surface and its distance from the isosurface it was made from.
struct FinishedSurface {
  geometry::TriangleMesh mesh_L;
  bool is_closed = false;
  Index self_intersections = 0;  ///< Pairs of triangles (mesh/self_intersections.h).
  /// 99th percentile and maximum of the vertex distances: from the surface to the isosurface or in
  /// the other direction, whichever is larger.
  double p99_off_mm = 0.0, max_off_mm = 0.0;
};

/// Smooths, decimates and measures a surface.
///
/// \param isosurface_L  of a scan.
/// \param voxel_mm      shortest edge of the scan's voxels; smoothing moves a vertex by at most
///   half of this length.
/// \param options       amount of smoothing and number of triangles.
/// \param progress      of the decimation; may request a stop.
/// \returns the surface, or the errors of simplify_surface() and count_self_intersections().
[[nodiscard]] Result<FinishedSurface> finish_surface(const geometry::TriangleMesh& isosurface_L,
                                                     double voxel_mm, const SurfaceFinish& options,
                                                     Progress& progress);

}  // namespace lefort::mesh
