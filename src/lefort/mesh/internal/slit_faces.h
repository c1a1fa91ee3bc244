/// \file
/// The faces between the elements on the two sides of a slit.
#pragma once

#include <lefort/mesh/open_slit.h>
#include <lefort/mesh/volume_mesh.h>

#include <vector>

namespace lefort::mesh::internal {

/// A face between two elements; elements are numbered through all blocks.
struct InnerFace {
  Face face;  ///< Counter-clockwise seen from outside the first element.
  Index first = 0, second = 0;
  bool is_within = false;   ///< Its center lies inside the border of the slit.
  bool is_on_slit = false;  ///< It lies between the two sides of the slit.
};

/// \returns all faces between two elements, with is_within, in the order of the first element.
[[nodiscard]] std::vector<InnerFace> inner_faces(const VolumeMesh& mesh,
                                                 const SlitSurface& surface);

/// Decides the side of each element, and marks the faces between the sides.
///
/// \param faces  of inner_faces(); is_on_slit is set.
/// \returns 1 for each element on the first side, else 0.
[[nodiscard]] std::vector<char> mark_slit_faces(const VolumeMesh& mesh, const SlitSurface& surface,
                                                std::vector<InnerFace>& faces);

/// Nodes of each element, through all blocks.
struct ElementNodes {
  ElementShape shape;
  const std::int32_t* nodes;
};
[[nodiscard]] std::vector<ElementNodes> elements_of(const VolumeMesh& mesh);

/// Mean of the nodes.
[[nodiscard]] Vec3 center_of(const VolumeMesh& mesh, std::span<const std::int32_t> nodes);

}  // namespace lefort::mesh::internal
