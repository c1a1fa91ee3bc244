#include <lefort/core/check.h>
#include <lefort/mesh/internal/disjoint_sets.h>
#include <lefort/mesh/internal/fit_to_slit.h>
#include <lefort/mesh/internal/slit_faces.h>
#include <lefort/mesh/open_slit.h>

#include <algorithm>
#include <map>
#include <utility>

namespace lefort::mesh {
namespace {

using internal::InnerFace;

/// Elements around the nodes of the slit, and the faces that join them.
struct Stars {
  std::map<std::int32_t, std::vector<Index>> elements;
  std::map<std::int32_t, std::vector<std::pair<Index, Index>>> joined;
};

Stars stars_of(const VolumeMesh& mesh, const std::vector<InnerFace>& faces) {
  Stars stars;
  for (const InnerFace& face : faces)
    if (face.is_on_slit)
      for (const std::int32_t node : nodes_of(face.face)) stars.elements[node];
  Index element = 0;
  for (const ElementBlock& block : mesh.blocks)
    for (Index e = 0; e < block.element_count(); ++e, ++element)
      for (int n = 0; n < node_count(block.shape); ++n)
        if (const auto star = stars.elements.find(block.element(e)[n]);
            star != stars.elements.end())
          star->second.push_back(element);
  for (const InnerFace& face : faces)
    if (!face.is_on_slit)
      for (const std::int32_t node : nodes_of(face.face))
        if (stars.elements.contains(node)) stars.joined[node].push_back({face.first, face.second});
  return stars;
}

/// For each element, the nodes that it gets instead of others.
using Replaced = std::map<std::pair<Index, std::int32_t>, std::int32_t>;

/// Duplicates the nodes whose elements the slit separates. The part with the first element on the
/// first side keeps the node.
Replaced duplicate_nodes(VolumeMesh& mesh, const std::vector<InnerFace>& faces,
                         const std::vector<char>& side) {
  const Stars stars = stars_of(mesh, faces);
  Replaced replaced;
  for (const auto& [node, elements] : stars.elements) {
    const auto local = [&elements = elements](Index e) {
      return std::size_t(std::lower_bound(elements.begin(), elements.end(), e) - elements.begin());
    };
    internal::DisjointSets parts(elements.size());
    if (const auto joined = stars.joined.find(node); joined != stars.joined.end())
      for (const auto& [a, b] : joined->second) parts.unite(local(a), local(b));
    const auto on_first = std::find_if(elements.begin(), elements.end(),
                                       [&](Index e) { return side[std::size_t(e)] != 0; });
    const std::size_t kept =
        parts.find(on_first == elements.end() ? 0 : std::size_t(on_first - elements.begin()));
    std::map<std::size_t, std::int32_t> node_of_part{{kept, node}};
    for (std::size_t e = 0; e < elements.size(); ++e) {
      const auto [part, is_new] =
          node_of_part.try_emplace(parts.find(e), std::int32_t(mesh.nodes_L.size()));
      if (is_new) mesh.nodes_L.push_back(Vec3(mesh.nodes_L[std::size_t(node)]));
      if (part->second != node) replaced[{elements[e], node}] = part->second;
    }
  }
  return replaced;
}

void replace_nodes(VolumeMesh& mesh, const Replaced& replaced) {
  Index first = 0;
  auto next = replaced.begin();
  for (ElementBlock& block : mesh.blocks) {
    const auto count = std::size_t(node_count(block.shape));
    for (; next != replaced.end() && next->first.first < first + block.element_count(); ++next) {
      const auto begin =
          block.nodes.begin() + std::ptrdiff_t(std::size_t(next->first.first - first) * count);
      std::replace(begin, begin + std::ptrdiff_t(count), next->first.second, next->second);
    }
    first += block.element_count();
  }
}

double area_of(const VolumeMesh& mesh, const Face& face) {
  const auto corner = [&](std::size_t n) { return mesh.nodes_L[std::size_t(face.nodes[n])]; };
  Vec3 area = (corner(1) - corner(0)).cross(corner(2) - corner(0));
  if (face.shape == FaceShape::kQuad4) area += (corner(2) - corner(0)).cross(corner(3) - corner(0));
  return 0.5 * area.norm();
}

Face reversed(Face face) {
  std::reverse(face.nodes.begin() + 1, face.nodes.begin() + node_count(face.shape));
  return face;
}

/// Adds the two faces at each cut face, and the pairs of nodes.
void add_faces(SlitMesh& slit, const std::vector<InnerFace>& faces, const std::vector<char>& side,
               const Replaced& replaced) {
  std::map<std::pair<std::int32_t, std::int32_t>, double> area_of_pair;
  for (const InnerFace& cut : faces) {
    if (!cut.is_on_slit) continue;
    const auto of_element = [&, &cut = cut](Index element, Face face) {
      for (int n = 0; n < node_count(face.shape); ++n)
        if (const auto at = replaced.find({element, face.nodes[std::size_t(n)]});
            at != replaced.end())
          face.nodes[std::size_t(n)] = at->second;
      return element == cut.first ? face : reversed(face);
    };
    const bool is_first = side[std::size_t(cut.first)] != 0;
    const Index on_first = is_first ? cut.first : cut.second;
    const Index on_second = is_first ? cut.second : cut.first;
    slit.first_faces.push_back(of_element(on_first, cut.face));
    slit.second_faces.push_back(of_element(on_second, cut.face));
    const double mm2 = area_of(slit.mesh, cut.face);
    slit.area_mm2 += mm2;
    const auto nodes = nodes_of(cut.face);
    const auto node_at = [&](Index element, std::int32_t node) {
      const auto at = replaced.find({element, node});
      return at == replaced.end() ? node : at->second;
    };
    for (const std::int32_t node : nodes)
      if (const std::int32_t a = node_at(on_first, node), b = node_at(on_second, node); a != b)
        area_of_pair[{a, b}] += mm2 / double(nodes.size());
  }
  for (const auto& [pair, mm2] : area_of_pair) slit.pairs.push_back({pair.first, pair.second, mm2});
}

}  // namespace

SlitMesh open_slit(VolumeMesh mesh, const SlitSurface& surface,
                   const std::function<bool(const Vec3&)>& is_inside_L) {
  LEFORT_CHECK(mesh.node_sets.empty() && mesh.face_sets.empty());
  std::vector<InnerFace> faces = internal::inner_faces(mesh, surface);
  const std::vector<char> side = internal::mark_slit_faces(mesh, surface, faces);
  SlitMesh slit;
  const bool is_on_slit = std::any_of(faces.begin(), faces.end(),
                                      [](const InnerFace& face) { return face.is_on_slit; });
  slit.mesh = std::move(mesh);
  if (!is_on_slit) return slit;
  slit.rms_distance_mm = internal::fit_to_slit(slit.mesh, surface, faces, is_inside_L);
  const Replaced replaced = duplicate_nodes(slit.mesh, faces, side);
  replace_nodes(slit.mesh, replaced);
  add_faces(slit, faces, side, replaced);
  return slit;
}

}  // namespace lefort::mesh
