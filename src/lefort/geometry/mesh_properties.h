/// \file
/// Questions a surface can answer about itself: size, closedness, parts.
#pragma once

#include <lefort/core/error.h>
#include <lefort/geometry/triangle_mesh.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace lefort::geometry {

/// Refuses what no function on surfaces can work with.
///
/// \returns kMeshInvalid if `mesh` has no triangle, a triangle names a vertex that is not there, or
///   a coordinate is not a finite number below 1e6 mm (the message names the first offender).
[[nodiscard]] Result<void> check_surface(const TriangleMesh& mesh);

/// Box of all vertices that a triangle uses.
[[nodiscard]] Box3 bounding_box(const TriangleMesh& mesh);

[[nodiscard]] double area_mm2(const TriangleMesh& mesh);

/// Enclosed volume [mm^3]: negative if the surface is inside out, meaningless if it is open.
[[nodiscard]] double signed_volume_mm3(const TriangleMesh& mesh);

/// Vertices in use, less edges, plus triangles: 2 for each sphere-like part, 0 for a torus.
[[nodiscard]] Index euler_characteristic(const TriangleMesh& mesh);

/// How triangles use an edge; a closed surface has one in each direction.
struct EdgeCount {
  std::int32_t from, to;  ///< Vertex numbers, from < to.
  int forward, backward;  ///< Triangles that run from -> to, and to -> from.
};

/// "edge 4-7 has 1 triangle" or the like, for messages.
[[nodiscard]] std::string describe(const EdgeCount& edge);

/// The first edge that does not have exactly two triangles in opposite directions.
[[nodiscard]] std::optional<EdgeCount> first_open_edge(const TriangleMesh& mesh);

/// True if every edge has exactly two triangles in opposite directions: a closed, oriented surface.
[[nodiscard]] inline bool is_closed(const TriangleMesh& mesh) { return !first_open_edge(mesh); }

/// The first edge that is not used as often in one direction as in the other. None means that the
/// surface encloses a volume, be it only by parts that touch along an edge.
[[nodiscard]] std::optional<EdgeCount> first_unbalanced_edge(const TriangleMesh& mesh);

/// Parts of a surface: triangles that share vertices, directly or through others.
struct Components {
  std::vector<std::int32_t> of_triangle;  ///< Numbered from 0 in the order of first appearance.
  std::int32_t count = 0;
};

[[nodiscard]] Components connected_components(const TriangleMesh& mesh);

/// The triangles for which keep(triangle) holds, in order, with the vertices they use.
[[nodiscard]] TriangleMesh keep_triangles(const TriangleMesh& mesh,
                                          const std::function<bool(Index triangle)>& keep);

/// The components for which keep(component as a mesh of its own) holds.
[[nodiscard]] TriangleMesh keep_components(const TriangleMesh& mesh,
                                           const std::function<bool(const TriangleMesh&)>& keep);

/// Makes vertices at bitwise equal positions one, drops triangles that then name a vertex twice and
/// vertices that no triangle uses. Order is kept.
[[nodiscard]] TriangleMesh weld_vertices(const TriangleMesh& mesh);

}  // namespace lefort::geometry
