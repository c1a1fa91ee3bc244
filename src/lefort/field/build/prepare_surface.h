/// \file
/// Repairs a triangle soup so that signed distances can be computed, and reports the repairs.
#pragma once

#include <lefort/core/error.h>
#include <lefort/field/mesh_repair_report.h>
#include <lefort/geometry/pseudonormals.h>
#include <lefort/geometry/triangle_mesh.h>

#include <string>
#include <vector>

namespace lefort::field {

/// One sentence per kind of repair or defect, except duplicate vertices; empty for a clean surface.
[[nodiscard]] std::vector<std::string> describe(const MeshRepairReport& report);

/// A repaired surface.
struct PreparedSurface {
  geometry::TriangleMesh mesh_B;
  geometry::Pseudonormals normals;
  std::vector<bool> is_opposite_duplicate;  ///< By triangle; empty if there are none.
  bool closed = false;   ///< Each edge has equally many triangles in both directions.
  Index components = 0;  ///< Number of connected components (linked by edges).
  MeshRepairReport report;
};

/// Welds vertices, drops duplicate triangles, and orients triangles consistently. In each component
/// that is connected by edges with two triangles and is orientable, the triangles of one of the two
/// orientations are flipped: of the one with the smaller total area. Then, if the surface is
/// closed, each component with negative volume that no other component encloses is flipped, with
/// all components inside it. A component of negative volume inside another one is a cavity.
///
/// \param surface_B  any triangle soup.
/// \returns the repaired surface; or kMeshInvalid as check_surface(), or if two corners coincide in
///   every triangle.
[[nodiscard]] Result<PreparedSurface> prepare_surface(const geometry::TriangleMesh& surface_B);

}  // namespace lefort::field
