#include <lefort/mesh/boundary_faces.h>
#include <lefort/mesh/internal/face_key.h>

#include <algorithm>

namespace lefort::mesh {
namespace {

/// One face of one element; the adjacent element has a face with the same key.
struct FaceUse {
  internal::FaceKey key;
  std::size_t order;
};

/// For each face of each element, in order: whether no other element has it.
std::vector<char> single_faces(const VolumeMesh& mesh) {
  std::vector<FaceUse> uses;
  uses.reserve(std::size_t(4 * mesh.element_count()));
  internal::for_each_face(mesh, [&](const Face& face) {
    uses.push_back({internal::face_key(face), uses.size()});
  });
  std::sort(uses.begin(), uses.end(), [](const FaceUse& a, const FaceUse& b) {
    return a.key != b.key ? a.key < b.key : a.order < b.order;
  });
  std::vector<char> is_single(uses.size(), 0);
  for (std::size_t first = 0; first < uses.size();) {
    std::size_t end = first + 1;
    while (end < uses.size() && uses[end].key == uses[first].key) ++end;
    if (end - first == 1) is_single[uses[first].order] = 1;
    first = end;
  }
  return is_single;
}

/// \returns the triangles of a face by the local numbers of its nodes.
std::span<const std::array<std::size_t, 3>> triangles_of(FaceShape shape) {
  using FaceCorners = std::array<std::size_t, 3>;
  static constexpr std::array<FaceCorners, 1> kTri3Corners{{{0, 1, 2}}};
  static constexpr std::array<FaceCorners, 2> kQuad4Corners{{{0, 1, 2}, {0, 2, 3}}};
  static constexpr std::array<FaceCorners, 4> kTri6Corners{
      {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}}};
  static constexpr std::array<FaceCorners, 6> kQuad8Corners{
      {{0, 4, 7}, {1, 5, 4}, {2, 6, 5}, {3, 7, 6}, {4, 5, 6}, {4, 6, 7}}};
  switch (shape) {
    case FaceShape::kTri3:
      return kTri3Corners;
    case FaceShape::kQuad4:
      return kQuad4Corners;
    case FaceShape::kTri6:
      return kTri6Corners;
    case FaceShape::kQuad8:
      break;
  }
  return kQuad8Corners;
}

}  // namespace

std::vector<Face> boundary_faces(const VolumeMesh& mesh) {
  const std::vector<char> is_single = single_faces(mesh);
  std::vector<Face> faces;
  std::size_t order = 0;
  internal::for_each_face(mesh, [&](const Face& face) {
    if (is_single[order++] != 0) faces.push_back(face);
  });
  return faces;
}

std::vector<Face3> triangles_of(std::span<const Face> faces) {
  std::vector<Face3> triangles;
  triangles.reserve(faces.size());
  for (const Face& face : faces)
    for (const auto& [a, b, c] : triangles_of(face.shape))
      triangles.push_back({face.nodes[a], face.nodes[b], face.nodes[c]});
  return triangles;
}

std::vector<std::int32_t> nodes_of_faces(std::span<const Face> faces) {
  std::vector<std::int32_t> nodes;
  nodes.reserve(3 * faces.size());
  for (const Face& face : faces) {
    const auto of_face = nodes_of(face);
    nodes.insert(nodes.end(), of_face.begin(), of_face.end());
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

}  // namespace lefort::mesh
