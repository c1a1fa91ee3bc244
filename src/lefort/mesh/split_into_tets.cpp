#include <lefort/core/check.h>
#include <lefort/mesh/element_faces.h>
#include <lefort/mesh/split_into_tets.h>

#include <algorithm>
#include <span>
#include <utility>

namespace lefort::mesh {
namespace {

/// First of some nodes by position.
std::int32_t first_of(std::span<const std::int32_t> nodes, const std::vector<Vec3>& nodes_L) {
  return *std::min_element(nodes.begin(), nodes.end(), [&](std::int32_t a, std::int32_t b) {
    const Vec3 &p = nodes_L[std::size_t(a)], &q = nodes_L[std::size_t(b)];
    return std::lexicographical_compare(p.data(), p.data() + 3, q.data(), q.data() + 3);
  });
}

/// The triangles of a face, with its orientation.
std::vector<Face3> split_face(const Face& face, const std::vector<Vec3>& nodes_L) {
  const auto& n = face.nodes;
  if (face.shape == FaceShape::kTri3) return {{n[0], n[1], n[2]}};
  LEFORT_CHECK(face.shape == FaceShape::kQuad4);
  const std::int32_t first = first_of(nodes_of(face), nodes_L);
  if (first == n[0] || first == n[2]) return {{n[0], n[1], n[2]}, {n[0], n[2], n[3]}};
  return {{n[1], n[2], n[3]}, {n[1], n[3], n[0]}};
}

}  // namespace

VolumeMesh split_into_tets(VolumeMesh mesh) {
  ElementBlock tets{.shape = ElementShape::kTet4, .nodes = {}, .region = {}};
  for (const ElementBlock& block : mesh.blocks) {
    LEFORT_CHECK(node_count(block.shape) == corner_count(block.shape));
    for (Index e = 0; e < block.element_count(); ++e) {
      const std::int32_t* element = block.element(e);
      const std::span nodes(element, std::size_t(node_count(block.shape)));
      if (block.shape == ElementShape::kTet4) {
        tets.nodes.insert(tets.nodes.end(), nodes.begin(), nodes.end());
        tets.region.push_back(block.region[std::size_t(e)]);
        continue;
      }
      const std::int32_t apex = first_of(nodes, mesh.nodes_L);
      for (const LocalFace& local : faces_of(block.shape)) {
        const Face face = face_of(element, local);
        const auto of_face = nodes_of(face);
        if (std::find(of_face.begin(), of_face.end(), apex) != of_face.end()) continue;
        for (const auto& [a, b, c] : split_face(face, mesh.nodes_L)) {
          tets.nodes.insert(tets.nodes.end(), {a, c, b, apex});
          tets.region.push_back(block.region[std::size_t(e)]);
        }
      }
    }
  }
  mesh.blocks = {std::move(tets)};
  for (auto& [name, faces] : mesh.face_sets) {
    std::vector<Face> triangles;
    for (const Face& face : faces)
      for (const auto& [a, b, c] : split_face(face, mesh.nodes_L))
        triangles.push_back({FaceShape::kTri3, {a, b, c}});
    faces = std::move(triangles);
  }
  return mesh;
}

}  // namespace lefort::mesh
