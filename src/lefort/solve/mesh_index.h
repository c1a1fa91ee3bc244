/// \file
/// What is asked of a mesh again and again while a deck is prepared, found once: its used nodes,
/// its regions, its boundary, and which elements have a face.
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
  std::array<std::int32_t, 4> corners;  ///< Ascending; a triangle's last is the largest number.
  std::int32_t element = 0;             ///< Through the blocks.
  std::int32_t local = 0;               ///< Of mesh::faces_of() its shape.
};

/// Belongs to the mesh it was made of. A value.
struct MeshIndex {
  std::vector<char> is_used;          ///< Of each node whether an element has it.
  std::vector<std::int32_t> regions;  ///< That occur, ascending.
  std::vector<FaceUse> faces;         ///< Of all elements, by corners, then by element.
  std::vector<mesh::Face> boundary;   ///< As mesh::boundary_faces().
};

/// \pre elements name nodes that exist, and as many as their shape has.
[[nodiscard]] MeshIndex index_mesh(const mesh::VolumeMesh& mesh);

/// All faces of elements that have the corners of `face`.
[[nodiscard]] std::span<const FaceUse> faces_like(const MeshIndex& index, const mesh::Face& face);

[[nodiscard]] mesh::Face face_of(const mesh::VolumeMesh& mesh, const FaceUse& use);
[[nodiscard]] std::int32_t region_of(const mesh::VolumeMesh& mesh, std::int32_t element);

/// "(x, y, z) mm", the mean of its nodes.
[[nodiscard]] std::string place_of(const mesh::VolumeMesh& mesh, const mesh::Face& face);

/// Refuses meshes whose elements touch without being joined.
///
/// \returns warnings of quadrilaterals that face two triangles; or kMeshInvalid, naming elements
///   and place: two elements share the corners of a face but not all its nodes, or more than two
///   have it.
[[nodiscard]] Result<std::vector<std::string>> check_joints(const mesh::VolumeMesh& mesh,
                                                            const MeshIndex& index);

}  // namespace lefort::solve
