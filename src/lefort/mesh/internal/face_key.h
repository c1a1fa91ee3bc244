/// \file
/// A key of a face that is the same for both elements at it: its sorted corners.
#pragma once

#include <lefort/mesh/element_faces.h>
#include <lefort/mesh/volume_mesh.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

namespace lefort::mesh::internal {

using FaceKey = std::array<std::int32_t, 4>;

/// \returns the corners, ascending; the last entry of a triangle is the largest integer.
[[nodiscard]] inline FaceKey face_key(const Face& face) {
  FaceKey key;
  key.fill(std::numeric_limits<std::int32_t>::max());
  std::copy_n(face.nodes.begin(), corner_count(face.shape), key.begin());
  std::sort(key.begin(), key.end());
  return key;
}

/// Calls visit(face) for all faces of all elements, in the order of blocks, elements, faces.
template <class Visit>
void for_each_face(const VolumeMesh& mesh, const Visit& visit) {
  for (const ElementBlock& block : mesh.blocks)
    for (Index e = 0; e < block.element_count(); ++e)
      for (const LocalFace& local : faces_of(block.shape)) visit(face_of(block.element(e), local));
}

}  // namespace lefort::mesh::internal
