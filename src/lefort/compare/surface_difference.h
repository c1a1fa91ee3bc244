/// \file
/// Distances of the vertices of one surface from another surface.
#pragma once

#include <lefort/geometry/bvh.h>
#include <lefort/geometry/triangle_mesh.h>

#include <vector>

namespace lefort::compare {

struct DifferenceOptions {
  double max_mm = 20.0;  ///< Vertices further away are not compared; > 0.
};

struct SurfaceDifference {
  /// One per vertex [mm]: distance to the closest point of the other surface, positive outside it;
  /// NaN if the vertex is not compared.
  std::vector<double> signed_mm;
  /// One per vertex [mm^2]: a third of the area of its triangles.
  std::vector<double> area_mm2;
  /// One per vertex [mm]: from the closest point of the other surface to the vertex; NaN as above.
  std::vector<Vec3> offset_mm{};
};

/// Computes the distance of every vertex of `from` from the surface `onto`.
///
/// A vertex is not compared if its closest point is further than `max_mm`, lies on a boundary edge
/// of `onto`, or has the opposite orientation (another sheet, such as the inner side of a lip).
///
/// \param from     oriented, valid according to check_surface().
/// \param onto     oriented.
/// \param options  which vertices are compared.
/// \returns the distances.
/// \note Closest points are not corresponding points: a surface that slides along itself has no
///   difference. Same bits for any number of threads.
[[nodiscard]] SurfaceDifference measure_difference(const geometry::TriangleMesh& from,
                                                   const geometry::Bvh& onto,
                                                   const DifferenceOptions& options = {});

/// \param mesh  a surface.
/// \returns a third of the area of the triangles around each vertex [mm^2].
[[nodiscard]] std::vector<double> vertex_areas(const geometry::TriangleMesh& mesh);

}  // namespace lefort::compare
