#include <lefort/core/check.h>
#include <lefort/mesh/boundary_faces.h>
#include <lefort/mesh/element_faces.h>
#include <lefort/mesh/elevate_order.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <utility>

namespace lefort::mesh {
namespace {

ElementShape quadratic(ElementShape shape) {
  switch (shape) {
    case ElementShape::kTet4:
      return ElementShape::kTet10;
    case ElementShape::kWedge6:
      return ElementShape::kWedge15;
    default:
      LEFORT_CHECK(shape == ElementShape::kHex8);
      return ElementShape::kHex20;
  }
}

/// Mid-edge nodes by the corners of their edges, ascending.
using MiddleNodes = std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t>;

Face quadratic_face(const Face& linear, const MiddleNodes& middle) {
  const int corners = node_count(linear.shape);
  LEFORT_CHECK(corners == corner_count(linear.shape));
  Face face = linear;
  face.shape = corners == 3 ? FaceShape::kTri6 : FaceShape::kQuad8;
  for (int i = 0; i < corners; ++i)
    face.nodes[std::size_t(corners + i)] = middle.at(
        std::minmax(linear.nodes[std::size_t(i)], linear.nodes[std::size_t((i + 1) % corners)]));
  return face;
}

void elevate_sets(VolumeMesh& mesh, const MiddleNodes& middle) {
  for (auto& [name, faces] : mesh.face_sets)
    for (Face& face : faces) face = quadratic_face(face, middle);
  for (auto& [name, nodes] : mesh.node_sets) {
    std::vector<std::int32_t> added;
    if (const auto faces = mesh.face_sets.find(name); faces != mesh.face_sets.end())
      added = nodes_of_faces(faces->second);
    else
      for (const auto& [ends, node] : middle)
        if (std::binary_search(nodes.begin(), nodes.end(), ends.first) &&
            std::binary_search(nodes.begin(), nodes.end(), ends.second))
          added.push_back(node);
    nodes.insert(nodes.end(), added.begin(), added.end());
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  }
}

}  // namespace

QuadraticMesh elevate_order(VolumeMesh linear) {
  QuadraticMesh elevated{std::move(linear), {}};
  VolumeMesh& mesh = elevated.mesh;
  MiddleNodes middle;
  for (ElementBlock& block : mesh.blocks) {
    const ElementBlock old = std::exchange(block, {});
    block = {.shape = quadratic(old.shape), .nodes = {}, .region = old.region};
    for (Index e = 0; e < old.element_count(); ++e) {
      const std::int32_t* node = old.element(e);
      block.nodes.insert(block.nodes.end(), node, node + node_count(old.shape));
      for (const auto& [i, j] : edges_of(old.shape)) {
        const std::pair<std::int32_t, std::int32_t> ends = std::minmax(node[i], node[j]);
        const auto [known, is_new] = middle.try_emplace(ends, std::int32_t(mesh.nodes_L.size()));
        if (is_new) {
          mesh.nodes_L.emplace_back(
              0.5 * (mesh.nodes_L[std::size_t(node[i])] + mesh.nodes_L[std::size_t(node[j])]));
          elevated.ends.push_back({ends.first, ends.second});
        }
        block.nodes.push_back(known->second);
      }
    }
  }
  elevate_sets(mesh, middle);
  return elevated;
}

}  // namespace lefort::mesh
