/// \file
/// Takes the steps of voxels out of a surface without shrinking it.
#pragma once

#include <lefort/geometry/triangle_mesh.h>

namespace lefort::geometry {

struct SmoothOptions {
  int passes = 10;      ///< >= 0; each is a step inwards and one outwards.
  double max_mm = 0.5;  ///< No vertex ends further from where it was; > 0.
};

/// Smooths by the mean of each vertex's neighbors, alternately towards it and as far away from it,
/// so that what is coarser than the steps keeps its size \cite taubin1995.
///
/// Open edges stay where they are. Thin walls keep their thickness within 2 * `max_mm`.
///
/// \pre check_surface(mesh) holds.
/// \note Same bits for any number of threads.
[[nodiscard]] TriangleMesh smooth_surface(TriangleMesh mesh, const SmoothOptions& options = {});

}  // namespace lefort::geometry
