#include <lefort/mesh/element_faces.h>
#include <lefort/solve/find_sets.h>
#include <lefort/solve/mesh_index.h>

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace lefort::solve {
namespace {

using FaceKey = std::array<std::int32_t, 4>;

FaceKey face_key(const mesh::Face& face) {
  FaceKey key;
  key.fill(std::numeric_limits<std::int32_t>::max());
  std::copy_n(face.nodes.begin(), mesh::corner_count(face.shape), key.begin());
  std::sort(key.begin(), key.end());
  return key;
}

/// An element as block and index in it.
struct BlockPlace {
  const mesh::ElementBlock& block;
  Index element;
};

BlockPlace find_element(const mesh::VolumeMesh& mesh, std::int32_t element) {
  Index remaining = element;
  for (const mesh::ElementBlock& block : mesh.blocks) {
    if (remaining < block.element_count()) return {block, remaining};
    remaining -= block.element_count();
  }
  return {mesh.blocks.back(), 0};  // Not of this mesh.
}

std::vector<FaceUse> all_faces(const mesh::VolumeMesh& mesh) {
  std::vector<FaceUse> uses;
  uses.reserve(std::size_t(4 * mesh.element_count()));
  std::int32_t number = 0;
  for (const mesh::ElementBlock& block : mesh.blocks)
    for (Index e = 0; e < block.element_count(); ++e, ++number) {
      std::int32_t local = 0;
      for (const mesh::LocalFace& face : mesh::faces_of(block.shape))
        uses.push_back({face_key(mesh::face_of(block.element(e), face)), number, local++});
    }
  std::sort(uses.begin(), uses.end(), [](const FaceUse& a, const FaceUse& b) {
    return a.corners != b.corners ? a.corners < b.corners : a.element < b.element;
  });
  return uses;
}

std::span<const FaceUse> uses_of(const MeshIndex& index, const FaceKey& key) {
  const auto first =
      std::lower_bound(index.faces.begin(), index.faces.end(), key,
                       [](const FaceUse& use, const FaceKey& k) { return use.corners < k; });
  auto end = first;
  while (end != index.faces.end() && end->corners == key) ++end;
  return {first, end};
}

std::vector<std::int32_t> sorted_nodes(const mesh::Face& face) {
  const auto nodes = mesh::nodes_of(face);
  std::vector<std::int32_t> sorted(nodes.begin(), nodes.end());
  std::sort(sorted.begin(), sorted.end());
  return sorted;
}

/// Whether two boundary triangles cover a boundary quadrilateral.
bool faces_two_triangles(const MeshIndex& index, const mesh::Face& quad) {
  const auto& n = quad.nodes;
  const auto is_there = [&](std::size_t a, std::size_t b, std::size_t c) {
    mesh::Face triangle;
    triangle.nodes = {n[a], n[b], n[c]};
    return faces_like(index, triangle).size() == 1;
  };
  return (is_there(0, 1, 2) && is_there(0, 2, 3)) || (is_there(0, 1, 3) && is_there(1, 2, 3));
}

}  // namespace

MeshIndex index_mesh(const mesh::VolumeMesh& mesh) {
  MeshIndex index{.is_used = nodes_of_elements(mesh),
                  .regions = regions_of(mesh),
                  .faces = all_faces(mesh),
                  .boundary = {}};
  std::vector<FaceUse> single;
  for (std::size_t k = 0; k < index.faces.size(); ++k) {
    const auto same = [&](std::size_t other) {
      return other < index.faces.size() && index.faces[other].corners == index.faces[k].corners;
    };
    if (!same(k + 1) && (k == 0 || !same(k - 1))) single.push_back(index.faces[k]);
  }
  std::sort(single.begin(), single.end(), [](const FaceUse& a, const FaceUse& b) {
    return a.element != b.element ? a.element < b.element : a.local < b.local;
  });
  index.boundary.reserve(single.size());
  for (const FaceUse& use : single) index.boundary.push_back(face_of(mesh, use));
  return index;
}

std::span<const FaceUse> faces_like(const MeshIndex& index, const mesh::Face& face) {
  return uses_of(index, face_key(face));
}

mesh::Face face_of(const mesh::VolumeMesh& mesh, const FaceUse& use) {
  const auto [block, e] = find_element(mesh, use.element);
  return mesh::face_of(block.element(e), mesh::faces_of(block.shape)[std::size_t(use.local)]);
}

std::int32_t region_of(const mesh::VolumeMesh& mesh, std::int32_t element) {
  const auto [block, e] = find_element(mesh, element);
  return block.region[std::size_t(e)];
}

std::string place_of(const mesh::VolumeMesh& mesh, const mesh::Face& face) {
  Vec3 at_L = Vec3::Zero();
  const auto nodes = mesh::nodes_of(face);
  for (const std::int32_t node : nodes)
    at_L += mesh.nodes_L[std::size_t(node)] / double(nodes.size());
  return fmt::format("({:.3f}, {:.3f}, {:.3f}) mm", at_L.x(), at_L.y(), at_L.z());
}

Result<std::vector<std::string>> check_joints(const mesh::VolumeMesh& mesh,
                                              const MeshIndex& index) {
  for (std::size_t k = 1; k < index.faces.size(); ++k) {
    const FaceUse &first = index.faces[k - 1], &second = index.faces[k];
    if (first.corners != second.corners) continue;
    const mesh::Face one = face_of(mesh, first), other = face_of(mesh, second);
    if (k + 1 < index.faces.size() && index.faces[k + 1].corners == second.corners)
      return fail(
          ErrorCode::kMeshInvalid,
          fmt::format("elements {}, {} and {} share one face at {}; at most two may", first.element,
                      second.element, index.faces[k + 1].element, place_of(mesh, one)));
    if (sorted_nodes(one) != sorted_nodes(other))
      return fail(
          ErrorCode::kMeshInvalid,
          fmt::format("elements {} and {} share the corners of a face at {} but not all its nodes "
                      "({} and {}); a gap would open along its edges",
                      first.element, second.element, place_of(mesh, one),
                      mesh::node_count(one.shape), mesh::node_count(other.shape)));
  }
  std::vector<std::string> warnings;
  Index nonconforming = 0;
  std::string first_place;
  for (const mesh::Face& face : index.boundary) {
    if (mesh::corner_count(face.shape) != 4 || !faces_two_triangles(index, face)) continue;
    if (nonconforming++ == 0)
      first_place = fmt::format("of element {} at {}", faces_like(index, face)[0].element,
                                place_of(mesh, face));
  }
  if (nonconforming > 0)
    warnings.push_back(
        fmt::format("{} quadrilaterals lie on two triangles each and are connected to them only at "
                    "their nodes; the first is {}",
                    nonconforming, first_place));
  return warnings;
}

}  // namespace lefort::solve
