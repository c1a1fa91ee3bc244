#include <lefort/core/check.h>
#include <lefort/mesh/boundary_faces.h>

#include <algorithm>

namespace lefort::mesh {
namespace {

// Face f lies opposite corner f of the tetrahedron, counter-clockwise seen from outside:
//
//        3
//       /|\         volume > 0: 0, 1, 2 run
//      / | \        counter-clockwise seen
//     0--|--2       from 3
//      \ | /
//        1
constexpr std::array<std::array<std::size_t, 3>, 4> kTetFaces{
    {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

/// A face under its sorted nodes, so that both elements beside it give the same key.
struct FaceUse {
  Face3 key;
  Index order;
  Face3 face;
};

}  // namespace

std::vector<Face3> boundary_faces(const VolumeMesh& mesh) {
  std::vector<FaceUse> uses;
  uses.reserve(std::size_t(4 * mesh.element_count()));
  for (const ElementBlock& block : mesh.blocks) {
    LEFORT_CHECK(block.shape == ElementShape::kTet4);
    for (Index e = 0; e < block.element_count(); ++e)
      for (const auto& corners : kTetFaces) {
        const std::int32_t* tet = block.element(e);
        const Face3 face{tet[corners[0]], tet[corners[1]], tet[corners[2]]};
        Face3 key = face;
        std::sort(key.begin(), key.end());
        uses.push_back({key, Index(uses.size()), face});
      }
  }
  std::sort(uses.begin(), uses.end(), [](const FaceUse& a, const FaceUse& b) {
    return a.key != b.key ? a.key < b.key : a.order < b.order;
  });

  std::vector<FaceUse> single;
  for (std::size_t first = 0; first < uses.size();) {
    std::size_t end = first + 1;
    while (end < uses.size() && uses[end].key == uses[first].key) ++end;
    if (end - first == 1) single.push_back(uses[first]);
    first = end;
  }
  std::sort(single.begin(), single.end(),
            [](const FaceUse& a, const FaceUse& b) { return a.order < b.order; });

  std::vector<Face3> faces;
  faces.reserve(single.size());
  for (const FaceUse& use : single) faces.push_back(use.face);
  return faces;
}

std::vector<std::int32_t> nodes_of_faces(std::span<const Face3> faces) {
  std::vector<std::int32_t> nodes;
  nodes.reserve(3 * faces.size());
  for (const Face3& face : faces) nodes.insert(nodes.end(), face.begin(), face.end());
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

}  // namespace lefort::mesh
