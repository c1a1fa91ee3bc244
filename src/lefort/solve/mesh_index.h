/// \file
/// Index of a mesh for the preparation of a deck: used nodes, regions, boundary, and the elements
/// of each face.
#pragma once

#include <lefort/core/error.h>
#include <lefort/mesh/volume_mesh.h>

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace lefort::solve {

/// A face of an element.
struct FaceUse {
  std::array<std::int32_t, 4> corners;  ///< Ascending; of a triangle the last is the max of int32.
  std::int32_t element = 0;             ///< Number through the blocks.
  std::int32_t local = 0;               ///< Index in mesh::faces_of() of its shape.
};

/// Valid for the mesh that it was made from.
struct MeshIndex {
  std::vector<char> is_used;          ///< For each node whether it belongs to an element.
  std::vector<std::int32_t> regions;  ///< That occur, ascending.
  std::vector<FaceUse> faces;         ///< Of all elements, by corners, then by element.
  std::vector<mesh::Face> boundary;   ///< As mesh::boundary_faces().
};

/// \pre nodes of elements exist, and their number fits the shape.
[[nodiscard]] MeshIndex index_mesh(const mesh::VolumeMesh& mesh);

/// All faces of elements that have the corners of `face`.
[[nodiscard]] std::span<const FaceUse> faces_like(const MeshIndex& index, const mesh::Face& face);

/// The face with its nodes.
[[nodiscard]] mesh::Face face_of(const mesh::VolumeMesh& mesh, const FaceUse& use);
/// Region of an element, numbered through the blocks.
[[nodiscard]] std::int32_t region_of(const mesh::VolumeMesh& mesh, std::int32_t element);

/// Mean of the nodes of a face as "(x, y, z) mm".
[[nodiscard]] std::string place_of(const mesh::VolumeMesh& mesh, const mesh::Face& face);

/// Checks that elements that touch along a face are connected.
///
/// \param mesh   to check.
/// \param index  of the mesh.
/// \returns warnings of quadrilaterals that lie on two triangles; or kMeshInvalid, with elements
///   and position: two elements share the corners of a face but not all its nodes, or more than two
///   share a face.
[[nodiscard]] Result<std::vector<std::string>> check_joints(const mesh::VolumeMesh& mesh,
                                                            const MeshIndex& index);

}  // namespace lefort::solve
