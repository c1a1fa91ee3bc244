#include <lefort/mesh/element_faces.h>
#include <lefort/mesh/internal/disjoint_sets.h>
#include <lefort/mesh/internal/face_key.h>
#include <lefort/mesh/internal/slit_faces.h>

#include <algorithm>

namespace lefort::mesh::internal {
namespace {

/// Passes that even out the sides; two are usual.
constexpr int kMaxPasses = 10;
/// Parts with a smaller fraction of the elements stay joined.
constexpr double kMinPart = 0.01;

/// Elements with more faces towards the other side than towards their own change to it.
void even_out(std::vector<char>& side, const std::vector<InnerFace>& faces) {
  std::vector<std::vector<Index>> faces_of(side.size());
  for (std::size_t f = 0; f < faces.size(); ++f)
    if (faces[f].is_within) {
      faces_of[std::size_t(faces[f].first)].push_back(Index(f));
      faces_of[std::size_t(faces[f].second)].push_back(Index(f));
    }
  for (int pass = 0; pass < kMaxPasses; ++pass) {
    bool has_changed = false;
    for (std::size_t e = 0; e < side.size(); ++e) {
      int own = 0, other = 0;
      for (const Index f : faces_of[e]) {
        const InnerFace& face = faces[std::size_t(f)];
        const auto neighbor = std::size_t(face.first == Index(e) ? face.second : face.first);
        ++(side[neighbor] == side[e] ? own : other);
      }
      if (other <= own) continue;
      side[e] = char(1 - side[e]);
      has_changed = true;
    }
    if (!has_changed) break;
  }
}

/// Joins small parts again, because nothing would hold them.
void join_small_parts(std::vector<InnerFace>& faces, std::size_t element_count) {
  DisjointSets parts(element_count);
  for (const InnerFace& face : faces)
    if (!face.is_on_slit) parts.unite(std::size_t(face.first), std::size_t(face.second));
  std::vector<std::size_t> size(element_count, 0);
  for (std::size_t e = 0; e < element_count; ++e) ++size[parts.find(e)];
  const auto is_small = [&](Index e) {
    return double(size[parts.find(std::size_t(e))]) < kMinPart * double(element_count);
  };
  for (InnerFace& face : faces)
    if (face.is_on_slit && (is_small(face.first) || is_small(face.second))) face.is_on_slit = false;
}

}  // namespace

std::vector<ElementNodes> elements_of(const VolumeMesh& mesh) {
  std::vector<ElementNodes> elements;
  elements.reserve(std::size_t(mesh.element_count()));
  for (const ElementBlock& block : mesh.blocks)
    for (Index e = 0; e < block.element_count(); ++e)
      elements.push_back({block.shape, block.element(e)});
  return elements;
}

Vec3 center_of(const VolumeMesh& mesh, std::span<const std::int32_t> nodes) {
  Vec3 sum = Vec3::Zero();
  for (const std::int32_t node : nodes) sum += mesh.nodes_L[std::size_t(node)];
  return sum / double(nodes.size());
}

std::vector<InnerFace> inner_faces(const VolumeMesh& mesh, const SlitSurface& surface) {
  struct Use {
    FaceKey key;
    Index element;
    Face face;
  };
  std::vector<Use> uses;
  Index element = 0;
  for (const ElementBlock& block : mesh.blocks)
    for (Index e = 0; e < block.element_count(); ++e, ++element)
      for (const LocalFace& local : faces_of(block.shape)) {
        const Face face = face_of(block.element(e), local);
        uses.push_back({face_key(face), element, face});
      }
  std::sort(uses.begin(), uses.end(), [](const Use& a, const Use& b) {
    return a.key != b.key ? a.key < b.key : a.element < b.element;
  });
  std::vector<InnerFace> faces;
  for (std::size_t u = 0; u + 1 < uses.size(); ++u)
    if (uses[u].key == uses[u + 1].key)
      faces.push_back(
          {.face = uses[u].face,
           .first = uses[u].element,
           .second = uses[u + 1].element,
           .is_within = surface.extent_L(center_of(mesh, nodes_of(uses[u].face))) > 0.0});
  std::stable_sort(faces.begin(), faces.end(),
                   [](const InnerFace& a, const InnerFace& b) { return a.first < b.first; });
  return faces;
}

std::vector<char> mark_slit_faces(const VolumeMesh& mesh, const SlitSurface& surface,
                                  std::vector<InnerFace>& faces) {
  std::vector<char> side;
  for (const auto& [shape, nodes] : elements_of(mesh))
    side.push_back(
        char(surface.level_set_L(center_of(mesh, {nodes, std::size_t(node_count(shape))})) >= 0.0));
  even_out(side, faces);
  for (InnerFace& face : faces)
    face.is_on_slit =
        face.is_within && side[std::size_t(face.first)] != side[std::size_t(face.second)];
  join_small_parts(faces, side.size());
  return side;
}

}  // namespace lefort::mesh::internal
