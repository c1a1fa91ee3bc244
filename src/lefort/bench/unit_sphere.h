/// \file
/// Spheres from polyhedra, for benchmarks.
#pragma once

#include <lefort/geometry/triangle_mesh.h>

namespace lefort::bench {

/// Divides each triangle into four; the middles of edges are moved to the unit sphere.
/// \param ball  closed, with its vertices on the unit sphere; is changed.
void halve_edges(geometry::TriangleMesh& ball);

}  // namespace lefort::bench
