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

/// One sentence per repair or defect; empty for a clean surface.
[[nodiscard]] std::vector<std::string> describe(const MeshRepairReport& report);

/// A repaired surface.
struct PreparedSurface {
  geometry::TriangleMesh mesh_B;
  geometry::Pseudonormals normals;
  std::vector<bool> is_opposite_duplicate;  ///< By triangle; empty if there are none.
  bool closed = false;  ///< Each edge has equally many triangles in both directions.
  Index parts = 0;      ///< Number of components, connected by edges.
  MeshRepairReport report;
};

/// Welds vertices, drops duplicate triangles, and orients triangles consistently: in each component
/// that is connected by edges with two triangles, those with the smaller total area are flipped. A
/// closed component that encloses a negative volume is flipped if no other component encloses it;
/// inside another one it is a cavity.
///
/// \param surface_B  any triangle soup.
/// \returns the repaired surface; or kMeshInvalid if it is empty, not finite, too large, or all
///   triangles are degenerate.
[[nodiscard]] Result<PreparedSurface> prepare_surface(const geometry::TriangleMesh& surface_B);

}  // namespace lefort::field
