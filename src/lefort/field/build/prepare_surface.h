/// \file
/// Makes of any triangle soup a surface that a distance can be signed by, and says what it found.
#pragma once

#include <lefort/core/error.h>
#include <lefort/field/mesh_repair_report.h>
#include <lefort/geometry/pseudonormals.h>
#include <lefort/geometry/triangle_mesh.h>

#include <string>
#include <vector>

namespace lefort::field {

/// One sentence per finding that a user should know of; empty for a clean surface.
[[nodiscard]] std::vector<std::string> describe(const MeshRepairReport& report);

struct PreparedSurface {
  geometry::TriangleMesh mesh_B;
  geometry::Pseudonormals normals;
  std::vector<bool> is_double;  ///< By triangle; empty if there are none.
  bool closed = false;          ///< Encloses a volume: as many sides each way on every edge.
  Index parts = 0;              ///< That hang together by edges.
  MeshRepairReport report;
};

/// Welds vertices, drops what repeats, and turns triangles so that neighbors agree: within each
/// part that is connected by edges with two triangles, the smaller area to the larger. A closed
/// part that encloses a negative volume is turned if no other part surrounds it; inside another it
/// is a cavity.
///
/// \returns kMeshInvalid if the surface is empty, not finite, too large, or all triangles collapse.
[[nodiscard]] Result<PreparedSurface> prepare_surface(const geometry::TriangleMesh& surface_B);

}  // namespace lefort::field
