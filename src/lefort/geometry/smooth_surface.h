/// \file
/// Removes voxel steps from a surface without shrinking it.
#pragma once

#include <lefort/geometry/triangle_mesh.h>

namespace lefort::geometry {

struct SmoothOptions {
  int passes = 10;      ///< >= 0; each is an inward and an outward step.
  double max_mm = 0.5;  ///< Largest displacement of a vertex; > 0.
};

/// Moves each vertex alternately towards the mean of its neighbors and away from it, so that
/// features larger than the voxel steps keep their size \cite taubin1995.
///
/// Boundary edges do not move. Thin walls keep their thickness within 2 * `max_mm`.
///
/// \param mesh     the surface. \pre check_surface(mesh) succeeds.
/// \param options  amount of smoothing.
/// \note The result has the same bits for any number of threads.
[[nodiscard]] TriangleMesh smooth_surface(TriangleMesh mesh, const SmoothOptions& options = {});

}  // namespace lefort::geometry
