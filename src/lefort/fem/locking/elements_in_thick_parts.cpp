#include <lefort/fem/elements/all_elements.h>
#include <lefort/fem/locking/dilatation_modes.h>
#include <lefort/fem/locking/elements_in_thick_parts.h>
#include <lefort/mesh/boundary_faces.h>
#include <lefort/mesh/element_faces.h>

#include <algorithm>
#include <span>
#include <variant>

namespace lefort::fem {
namespace {

using NodeFlags = std::vector<char>;

/// \returns for each element whether one of its corners is marked.
std::vector<char> elements_with_corner(const mesh::VolumeMesh& mesh, const NodeFlags& is_marked) {
  std::vector<char> result;
  result.reserve(std::size_t(mesh.element_count()));
  for (const mesh::ElementBlock& block : mesh.blocks)
    for (Index e = 0; e < block.element_count(); ++e) {
      const std::span corners(block.element(e), std::size_t(mesh::corner_count(block.shape)));
      result.push_back(char(std::ranges::any_of(
          corners, [&](std::int32_t node) { return is_marked[std::size_t(node)] != 0; })));
    }
  return result;
}

/// \returns the marks of the corners of these elements.
NodeFlags corners_of(const mesh::VolumeMesh& mesh, const std::vector<char>& elements) {
  NodeFlags is_marked(mesh.nodes_L.size(), 0);
  std::size_t number = 0;
  for (const mesh::ElementBlock& block : mesh.blocks)
    for (Index e = 0; e < block.element_count(); ++e)
      if (elements[number++] != 0)
        for (int a = 0; a < mesh::corner_count(block.shape); ++a)
          is_marked[std::size_t(block.element(e)[a])] = 1;
  return is_marked;
}

bool needs_flags(const mesh::ElementBlock& block) {
  return std::visit([]<class Element>(const Element&) { return kHasPointwiseBulk<Element>; },
                    element_of(block.shape));
}

}  // namespace

std::vector<char> elements_in_thick_parts(const mesh::VolumeMesh& mesh) {
  if (!std::ranges::any_of(mesh.blocks, needs_flags)) return {};
  NodeFlags is_interior(mesh.nodes_L.size(), 1);
  for (const std::int32_t node : mesh::nodes_of_faces(mesh::boundary_faces(mesh)))
    is_interior[std::size_t(node)] = 0;
  return elements_with_corner(mesh, corners_of(mesh, elements_with_corner(mesh, is_interior)));
}

}  // namespace lefort::fem
