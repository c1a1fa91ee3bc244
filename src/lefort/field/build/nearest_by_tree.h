/// \file
/// Finds the nearest triangle of points far from the surface with a tree.
#pragma once

#include <lefort/field/build/nearest_in_brick.h>
#include <lefort/field/build/triangle_tree.h>
#include <lefort/geometry/triangle_mesh.h>

namespace lefort::field {

/// Completes visit_triangles(): finds the nearest triangle of every point that has none yet.
/// Sixteen points traverse the tree together. The cost per point hardly grows with the distance
/// from the surface, while the number of triangles binned to a brick grows with the square of the
/// distance.
///
/// \param mesh             the surface.
/// \param tree             of `mesh`.
/// \param low              position of the first point of the brick [mm].
/// \param cell             spacing of its points [mm].
/// \param max_distance_mm  max distance of triangles.
/// \param simd             instruction set; all give the same bits.
/// \param nearest          points with a code are not changed. \pre their nearest triangle is
///   final; squared_mm2 of the other points is max_distance_mm^2.
void find_nearest(const geometry::TriangleMesh& mesh, const TriangleTree& tree, const Vec3& low,
                  double cell, double max_distance_mm, Simd simd, NearestInBrick& nearest);

}  // namespace lefort::field
