/// \file
/// Rigid transformation of a surface.
#pragma once

#include <lefort/geometry/triangle_mesh.h>

namespace lefort::geometry {

/// The surface with its vertices transformed from frame B to L.
///
/// \param mesh_B  in frame B.
/// \param X_LB    pose of B.
[[nodiscard]] inline TriangleMesh transformed(TriangleMesh mesh_B, const RigidTransform& X_LB) {
  for (Vec3& vertex : mesh_B.vertices) vertex = X_LB * vertex;
  return mesh_B;
}

}  // namespace lefort::geometry
