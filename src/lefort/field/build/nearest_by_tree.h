/// \file
/// Which triangle is nearest to each point of a brick that lies far from the surface.
#pragma once

#include <lefort/field/build/nearest_in_brick.h>
#include <lefort/field/build/triangle_tree.h>
#include <lefort/geometry/triangle_mesh.h>

namespace lefort::field {

/// Completes what visit_triangles() began: finds the nearest triangle for every point that has none
/// yet, sixteen points going down the tree together.
///
/// The work of a point hardly grows with its distance, while the triangles that reach a point grow
/// in number with the square of the reach.
///
/// \param low       position of the brick's first point; `cell` is the spacing.
/// \param reach_mm  a triangle matters to points this near only.
/// \param nearest   points with a code keep it. \pre they are settled: no triangle is nearer.
void find_nearest(const geometry::TriangleMesh& mesh, const TriangleTree& tree, const Vec3& low,
                  double cell, double reach_mm, Simd simd, NearestInBrick& nearest);

}  // namespace lefort::field
