/// \file
/// From an isosurface to one for people and other programs: smooth, no larger than asked for, and
/// with its flaws told.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/geometry/triangle_mesh.h>

#include <optional>

namespace lefort::mesh {

struct SurfaceFinish {
  int smoothing_passes = 10;         ///< geometry/smooth_surface.h; 0: none.
  std::optional<Index> triangles{};  ///< At most so many; none: as they come.
};

/// A surface and how it relates to the isosurface it was made from.
struct FinishedSurface {
  geometry::TriangleMesh mesh_L;
  bool is_closed = false;
  Index self_intersections = 0;  ///< Pairs of triangles (mesh/self_intersections.h).
  double p99_off_mm = 0.0;       ///< Of the distance between the two, the larger of both ways.
  double max_off_mm = 0.0;
};

/// \param isosurface_L  of a scan.
/// \param voxel_mm      the shortest side of its voxels; no vertex is smoothed further than half of
///   it.
/// \returns what simplify_surface() and count_self_intersections() return.
[[nodiscard]] Result<FinishedSurface> finish_surface(const geometry::TriangleMesh& isosurface_L,
                                                     double voxel_mm, const SurfaceFinish& options,
                                                     Progress& progress);

}  // namespace lefort::mesh
