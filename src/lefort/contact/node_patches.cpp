#include <lefort/contact/node_patches.h>
#include <lefort/core/check.h>
#include <lefort/fem/assembly/force_term.h>

#include <algorithm>
#include <map>

namespace lefort::contact {
namespace {

/// A face around a node.
struct AroundNode {
  std::size_t face = 0;
  std::uint8_t place = 0;  ///< Of the node in the face.
};

NodePatch patch_of(std::int32_t node, std::span<const AroundNode> around,
                   std::span<const mesh::Face> faces, std::span<const std::size_t> first_points) {
  NodePatch patch;
  for (const AroundNode& at : around)
    for (const std::int32_t n : mesh::nodes_of(faces[at.face])) patch.nodes.push_back(n);
  std::sort(patch.nodes.begin(), patch.nodes.end());
  patch.nodes.erase(std::unique(patch.nodes.begin(), patch.nodes.end()), patch.nodes.end());
  LEFORT_CHECK(patch.nodes.size() <= std::size_t(fem::kMaxLocalNodes));
  const auto place_of = [&](std::int32_t n) {
    return std::uint8_t(std::lower_bound(patch.nodes.begin(), patch.nodes.end(), n) -
                        patch.nodes.begin());
  };
  patch.center = place_of(node);
  for (const AroundNode& at : around) {
    PatchFace& part = patch.faces.emplace_back();
    part.shape = faces[at.face].shape;
    part.center = at.place;
    part.first_point = first_points[at.face];
    const auto nodes = mesh::nodes_of(faces[at.face]);
    for (std::size_t a = 0; a < nodes.size(); ++a) part.local[a] = place_of(nodes[a]);
  }
  return patch;
}

}  // namespace

NodePatches::NodePatches(std::span<const Vec3> nodes_L, std::span<const mesh::Face> faces) {
  std::map<std::int32_t, std::vector<AroundNode>> around;
  std::vector<std::size_t> first_points;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const auto nodes = mesh::nodes_of(faces[f]);
    std::array<Vec3, kMaxFaceNodes> x_L;
    for (std::size_t a = 0; a < nodes.size(); ++a) {
      around[nodes[a]].push_back({f, std::uint8_t(a)});
      x_L[a] = nodes_L[std::size_t(nodes[a])];
    }
    first_points.push_back(areas_mm2_.size());
    for (const WeightedPoint& point : weighted_quadrature(faces[f].shape))
      areas_mm2_.push_back(
          contact::area_mm2(point.at, std::span<const Vec3>(x_L.data(), nodes.size())));
  }
  for (const auto& [node, faces_around] : around) {
    NodePatch patch = patch_of(node, faces_around, faces, first_points);
    for (const PatchFace& part : patch.faces) {
      const auto points = weighted_quadrature(part.shape);
      for (std::size_t q = 0; q < points.size(); ++q)
        patch.area_mm2 += areas_mm2_[part.first_point + q] * points[q].M[part.center];
    }
    patches_.push_back(std::move(patch));
  }
}

}  // namespace lefort::contact
