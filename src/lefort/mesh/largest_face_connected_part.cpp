#include <lefort/core/check.h>
#include <lefort/mesh/internal/disjoint_sets.h>
#include <lefort/mesh/largest_face_connected_part.h>

#include <algorithm>
#include <bit>
#include <span>

namespace lefort::mesh {
namespace {

using Tet = std::array<std::int32_t, 4>;  // Sorted nodes.

/// \returns for each item whether it is in the largest set; among equals, in the first.
std::vector<bool> largest(internal::DisjointSets& sets) {
  std::vector<std::size_t> size(sets.size(), 0);
  for (std::size_t i = 0; i < size.size(); ++i) ++size[sets.find(i)];
  const auto name = std::size_t(std::max_element(size.begin(), size.end()) - size.begin());
  std::vector<bool> is_in(sets.size());
  for (std::size_t i = 0; i < is_in.size(); ++i) is_in[i] = sets.find(i) == name;
  return is_in;
}

/// \returns all subsets of n nodes (3: faces, 2: edges, 1: nodes) of all tetrahedra, each with its
/// tetrahedron.
template <std::size_t n>
std::vector<std::pair<std::array<std::int32_t, n>, std::size_t>> corners_of(
    const std::vector<Tet>& tets) {
  std::vector<std::pair<std::array<std::int32_t, n>, std::size_t>> corners;
  for (std::size_t t = 0; t < tets.size(); ++t)
    for (unsigned subset = 0; subset < 16; ++subset) {
      if (std::size_t(std::popcount(subset)) != n) continue;
      std::array<std::int32_t, n> nodes{};
      for (std::size_t c = 0, i = 0; c < 4; ++c)
        if ((subset >> c) & 1u) nodes[i++] = tets[t][c];
      corners.emplace_back(nodes, t);
    }
  std::sort(corners.begin(), corners.end());
  return corners;
}

bool share_face(const Tet& a, const Tet& b) {
  int shared = 0;
  for (const std::int32_t node : a) shared += std::count(b.begin(), b.end(), node) > 0;
  return shared == 3;
}

void keep_largest(std::vector<Tet>& tets, std::vector<std::size_t>& original) {
  internal::DisjointSets parts(tets.size());
  const auto faces = corners_of<3>(tets);
  for (std::size_t f = 1; f < faces.size(); ++f)
    if (faces[f].first == faces[f - 1].first) parts.unite(faces[f].second, faces[f - 1].second);
  const std::vector<bool> is_in = largest(parts);
  std::size_t kept = 0;
  for (std::size_t t = 0; t < tets.size(); ++t) {
    if (!is_in[t]) continue;
    tets[kept] = tets[t];
    original[kept++] = original[t];
  }
  tets.resize(kept);
  original.resize(kept);
}

/// Marks tetrahedra that are connected to the others around some edge (n = 2) or node (n = 1) only
/// through that edge or node.
template <std::size_t n>
void mark_hinged(const std::vector<Tet>& tets, std::vector<bool>& hinged) {
  const auto corners = corners_of<n>(tets);
  for (std::size_t first = 0; first < corners.size();) {
    std::size_t end = first + 1;
    while (end < corners.size() && corners[end].first == corners[first].first) ++end;
    internal::DisjointSets around(end - first);
    for (std::size_t i = first; i < end; ++i)
      for (std::size_t j = i + 1; j < end; ++j)
        if (share_face(tets[corners[i].second], tets[corners[j].second]))
          around.unite(i - first, j - first);
    const std::vector<bool> is_in = largest(around);
    for (std::size_t i = first; i < end; ++i)
      if (!is_in[i - first]) hinged[corners[i].second] = true;
    first = end;
  }
}

/// \returns whether any tetrahedron was removed.
bool drop_hinged(std::vector<Tet>& tets, std::vector<std::size_t>& original) {
  std::vector<bool> hinged(tets.size(), false);
  mark_hinged<2>(tets, hinged);
  mark_hinged<1>(tets, hinged);
  std::size_t kept = 0;
  for (std::size_t t = 0; t < tets.size(); ++t) {
    if (hinged[t]) continue;
    tets[kept] = tets[t];
    original[kept++] = original[t];
  }
  const bool any = kept < tets.size();
  tets.resize(kept);
  original.resize(kept);
  return any;
}

/// \returns the given elements with the nodes they use.
VolumeMesh keep_elements(const VolumeMesh& mesh, std::span<const std::size_t> elements) {
  const ElementBlock& block = mesh.blocks[0];
  VolumeMesh part;
  ElementBlock& kept = part.blocks.emplace_back();
  for (const std::size_t e : elements) {
    kept.nodes.insert(kept.nodes.end(), block.element(Index(e)), block.element(Index(e)) + 4);
    kept.region.push_back(block.region[e]);
  }
  std::vector<std::int32_t> new_number(std::size_t(mesh.node_count()), -1);
  for (const std::int32_t node : kept.nodes) new_number[std::size_t(node)] = 0;
  for (std::size_t node = 0; node < new_number.size(); ++node) {
    if (new_number[node] < 0) continue;
    new_number[node] = std::int32_t(part.nodes_L.size());
    part.nodes_L.push_back(mesh.nodes_L[node]);
  }
  for (std::int32_t& node : kept.nodes) node = new_number[std::size_t(node)];
  return part;
}

}  // namespace

VolumeMesh largest_face_connected_part(const VolumeMesh& mesh) {
  LEFORT_CHECK(mesh.blocks.size() == 1 && mesh.blocks[0].shape == ElementShape::kTet4);
  const ElementBlock& block = mesh.blocks[0];
  std::vector<Tet> tets(std::size_t(block.element_count()));
  std::vector<std::size_t> original(tets.size());
  for (std::size_t e = 0; e < tets.size(); ++e) {
    std::copy_n(block.element(Index(e)), 4, tets[e].begin());
    std::sort(tets[e].begin(), tets[e].end());
    original[e] = e;
  }
  do keep_largest(tets, original);
  while (!tets.empty() && drop_hinged(tets, original));
  return keep_elements(mesh, original);
}

}  // namespace lefort::mesh
