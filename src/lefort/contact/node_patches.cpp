#include <lefort/contact/node_patches.h>
#include <lefort/core/check.h>
#include <lefort/fem/assembly/force_term.h>
#include <lefort/mesh/element_faces.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

namespace lefort::contact {
namespace {

/// A face around a node.
struct AroundNode {
  std::size_t face = 0;
  std::uint8_t place = 0;  ///< Of the node in the face.
};

/// The corners of side i of a face, ascending.
std::pair<std::int32_t, std::int32_t> side_of(const mesh::Face& face, int i) {
  return std::minmax(face.nodes[std::size_t(i)],
                     face.nodes[std::size_t((i + 1) % mesh::corner_count(face.shape))]);
}

/// Sides and nodes where the faces end.
struct Border {
  std::vector<std::uint8_t> sides;  ///< PatchFace::border_sides of each face.
  std::set<std::int32_t> nodes;

  explicit Border(std::span<const mesh::Face> faces) {
    std::map<std::pair<std::int32_t, std::int32_t>, int> count;
    for (const mesh::Face& face : faces)
      for (int i = 0; i < mesh::corner_count(face.shape); ++i) ++count[side_of(face, i)];
    for (const mesh::Face& face : faces) {
      std::uint8_t& bits = sides.emplace_back(std::uint8_t(0));
      const int corners = mesh::corner_count(face.shape);
      for (int i = 0; i < corners; ++i) {
        const auto side = side_of(face, i);
        if (count.at(side) > 1) continue;
        bits = std::uint8_t(bits | 1U << unsigned(i));
        nodes.insert({side.first, side.second});
        if (mesh::node_count(face.shape) > corners)
          nodes.insert(face.nodes[std::size_t(corners + i)]);
      }
    }
  }
};

NodePatch patch_of(std::int32_t node, std::span<const AroundNode> around,
                   std::span<const mesh::Face> faces, std::span<const std::size_t> first_points,
                   const Border& border) {
  NodePatch patch;
  for (const AroundNode& at : around)
    for (const std::int32_t n : mesh::nodes_of(faces[at.face])) patch.nodes.push_back(n);
  std::sort(patch.nodes.begin(), patch.nodes.end());
  patch.nodes.erase(std::unique(patch.nodes.begin(), patch.nodes.end()), patch.nodes.end());
  LEFORT_CHECK(patch.nodes.size() <= std::size_t(kMaxPatchNodes));
  const auto place_of = [&](std::int32_t n) {
    return std::uint8_t(std::lower_bound(patch.nodes.begin(), patch.nodes.end(), n) -
                        patch.nodes.begin());
  };
  patch.center = place_of(node);
  for (const std::int32_t n : patch.nodes) patch.on_border.push_back(border.nodes.contains(n));
  for (const AroundNode& at : around) {
    PatchFace& part = patch.faces.emplace_back();
    part.shape = faces[at.face].shape;
    part.center = at.place;
    part.first_point = first_points[at.face];
    part.number = at.face;
    part.border_sides = border.sides[at.face];
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
  const Border border(faces);
  for (const auto& [node, faces_around] : around) {
    NodePatch patch = patch_of(node, faces_around, faces, first_points, border);
    for (const PatchFace& part : patch.faces) {
      const auto points = weighted_quadrature(part.shape);
      for (std::size_t q = 0; q < points.size(); ++q)
        patch.area_mm2 += areas_mm2_[part.first_point + q] * points[q].M[part.center];
    }
    patches_.push_back(std::move(patch));
  }
}

}  // namespace lefort::contact
