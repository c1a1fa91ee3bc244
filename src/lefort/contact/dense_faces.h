/// \file
/// Dense samples of faces, to report penetration between the points of a formulation.
#pragma once

#include <lefort/core/types.h>
#include <lefort/mesh/volume_mesh.h>

#include <span>
#include <vector>

namespace lefort::contact {

/// Samples of a face on a regular lattice, with nodes and edges.
struct DenseFace {
  const mesh::Face* face = nullptr;
  double area_mm2 = 0.0;
  std::vector<Vec3> points_L;
};

/// Samples the triangles of face_division(), whose edges are divided into six.
/// \param faces  must outlive the result.
/// \param x_L    positions of all nodes [mm].
/// \returns one entry per face; the number of its points depends on its shape only.
[[nodiscard]] std::vector<DenseFace> dense_faces(std::span<const mesh::Face> faces,
                                                 std::span<const Vec3> x_L);

}  // namespace lefort::contact
