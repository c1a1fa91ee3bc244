/// \file
/// Dense samples of faces, to report penetration between the quadrature points.
#pragma once

#include <lefort/contact/face_quadrature.h>
#include <lefort/core/types.h>
#include <lefort/mesh/volume_mesh.h>

#include <array>
#include <span>
#include <vector>

namespace lefort::contact {

/// A sample of a face.
struct DensePoint {
  Vec3 x_L;                                 ///< [mm].
  std::array<double, kMaxFaceNodes> hat{};  ///< Hat functions of the nodes of the face.
};

/// Samples of a face on a regular lattice, with nodes and edges. The mean of the hat functions of a
/// node over the lattice is that over the face, if the triangles of the division have equal areas.
struct DenseFace {
  const mesh::Face* face = nullptr;
  double area_mm2 = 0.0;
  std::vector<DensePoint> points;
};

/// Samples the triangles of face_division(), whose edges are divided into six.
/// \param faces  must outlive the result.
/// \param x_L    positions of all nodes [mm].
/// \returns one entry per face; the number of its points depends on its shape only.
[[nodiscard]] std::vector<DenseFace> dense_faces(std::span<const mesh::Face> faces,
                                                 std::span<const Vec3> x_L);

}  // namespace lefort::contact
