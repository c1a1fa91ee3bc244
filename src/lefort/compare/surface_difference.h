/// \file
/// How far one surface lies from another, vertex by vertex.
#pragma once

#include <lefort/geometry/bvh.h>
#include <lefort/geometry/triangle_mesh.h>

#include <vector>

namespace lefort::compare {

/// When a vertex has nothing on the other surface that it can be held against.
struct DifferenceOptions {
  double max_mm = 20.0;  ///< Further apart is no pair; > 0.
};

struct SurfaceDifference {
  /// One per vertex [mm]: to the nearest point of the other surface, positive where the vertex lies
  /// outside of it; NaN where it is not compared.
  std::vector<double> signed_mm;
  /// One per vertex [mm^2]: a third of the triangles around it.
  std::vector<double> area_mm2;
};

/// Distance from every vertex of `from` to the surface `onto`.
///
/// Not compared is a vertex whose nearest point is further than `max_mm`, lies on an open edge of
/// `onto` (the other surface ends there), or faces the other way (another sheet, as the inner side
/// of a lip).
///
/// \pre check_surface(from) holds, and both are oriented.
/// \note Nearest points do not tell which point moved where: a surface that slides along itself
///   shows no difference. Same bits for any number of threads.
[[nodiscard]] SurfaceDifference measure_difference(const geometry::TriangleMesh& from,
                                                   const geometry::Bvh& onto,
                                                   const DifferenceOptions& options = {});

/// A third of the area of the triangles around each vertex [mm^2].
[[nodiscard]] std::vector<double> vertex_areas(const geometry::TriangleMesh& mesh);

}  // namespace lefort::compare
