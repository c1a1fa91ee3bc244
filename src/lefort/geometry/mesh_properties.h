/// \file
/// Properties of a surface: size, closedness, connected components.
#pragma once

#include <lefort/core/error.h>
#include <lefort/geometry/triangle_mesh.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace lefort::geometry {

/// Checks that a surface is usable.
///
/// \param mesh  any triangle soup.
/// \returns kMeshInvalid if `mesh` has no triangle, more than 2^31 / 3 triangles or vertices, a
///   triangle with a vertex that does not exist, or a coordinate that is not finite or has a
///   magnitude of 1e6 mm or more (the message names the first one).
[[nodiscard]] Result<void> check_surface(const TriangleMesh& mesh);

/// Bounding box of all vertices that triangles use.
[[nodiscard]] Box3 bounding_box(const TriangleMesh& mesh);

/// Sum of the areas of all triangles.
[[nodiscard]] double area_mm2(const TriangleMesh& mesh);

/// Enclosed volume [mm^3]: negative if the surface is oriented inward, meaningless if it is open.
[[nodiscard]] double signed_volume_mm3(const TriangleMesh& mesh);

/// Vertices in use - edges + triangles: 2 for each sphere-like component, 0 for a torus.
[[nodiscard]] Index euler_characteristic(const TriangleMesh& mesh);

/// Number of triangles at an edge; a closed surface has one in each direction.
struct EdgeCount {
  std::int32_t from, to;  ///< Vertex numbers, from < to.
  int forward, backward;  ///< Triangles with the half-edge from -> to, and to -> from.
};

/// Description for messages, for example "edge 4-7 has 1 triangle".
[[nodiscard]] std::string describe(const EdgeCount& edge);

/// The first edge that does not have exactly two triangles in opposite directions.
[[nodiscard]] std::optional<EdgeCount> first_open_edge(const TriangleMesh& mesh);

/// True if every edge has exactly two triangles in opposite directions: a closed, oriented surface.
[[nodiscard]] inline bool is_closed(const TriangleMesh& mesh) { return !first_open_edge(mesh); }

/// The first edge with unequal numbers of triangles in its two directions. Without one, the surface
/// encloses a volume, even if components touch along an edge.
[[nodiscard]] std::optional<EdgeCount> first_unbalanced_edge(const TriangleMesh& mesh);

/// Connected components: triangles with common vertices, directly or through others.
struct Components {
  std::vector<std::int32_t> of_triangle;  ///< Numbered from 0 in the order of first appearance.
  std::int32_t count = 0;
};

/// Finds the connected components of a surface.
[[nodiscard]] Components connected_components(const TriangleMesh& mesh);

/// The triangles for which keep(triangle) is true, in order, with the vertices they use.
///
/// \param mesh  any triangle soup.
/// \param keep  called once per triangle.
[[nodiscard]] TriangleMesh keep_triangles(const TriangleMesh& mesh,
                                          const std::function<bool(Index triangle)>& keep);

/// The connected components for which keep(component as a mesh) is true.
///
/// \param mesh  any triangle soup.
/// \param keep  called once per component.
[[nodiscard]] TriangleMesh keep_components(const TriangleMesh& mesh,
                                           const std::function<bool(const TriangleMesh&)>& keep);

/// Merges vertices at exactly equal positions; drops triangles that then repeat a vertex, and
/// vertices that no triangle uses. Order is kept.
[[nodiscard]] TriangleMesh weld_vertices(const TriangleMesh& mesh);

}  // namespace lefort::geometry
