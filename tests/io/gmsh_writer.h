/// \file
/// Writes Gmsh files of format 4.1, text and binary, from the tables of Gmsh's reference manual.
#pragma once

#include <lefort/core/types.h>
#include <lefort/mesh/element_faces.h>
#include <lefort/mesh/volume_mesh.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace lefort::test {

enum class GmshForm { kText, kBinary };

/// The body of one section, number by number.
class GmshNumbers {
 public:
  explicit GmshNumbers(GmshForm form) : form_(form) {}
  GmshNumbers& whole(int value) { return add(value); }
  GmshNumbers& size(std::uint64_t value) { return add(value); }
  GmshNumbers& real(double value) { return add(value); }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  template <class T>
  GmshNumbers& add(T value) {
    if (form_ == GmshForm::kText) {
      bytes_ += fmt::format("{} ", value);
    } else {
      bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
    }
    return *this;
  }
  GmshForm form_;
  std::string bytes_;
};

/// Node ordering of an element in Gmsh: its corners in our numbering, and the pairs of its own
/// corners with a mid-edge node ("Node ordering" in the manual).
struct GmshPicture {
  int type;
  std::vector<int> corners;
  std::vector<std::array<int, 2>> edges;
};

inline GmshPicture gmsh_picture(mesh::ElementShape shape) {
  using Edges = std::vector<std::array<int, 2>>;
  const Edges tet{{0, 1}, {1, 2}, {2, 0}, {3, 0}, {3, 2}, {3, 1}};
  const Edges hex{{0, 1}, {0, 3}, {0, 4}, {1, 2}, {1, 5}, {2, 3},
                  {2, 6}, {3, 7}, {4, 5}, {4, 7}, {5, 6}, {6, 7}};
  const Edges prism{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 4}, {2, 5}, {3, 4}, {3, 5}, {4, 5}};
  switch (shape) {
    case mesh::ElementShape::kTet4:
      return {4, {0, 1, 2, 3}, {}};
    case mesh::ElementShape::kPyramid5:
      return {7, {0, 1, 2, 3, 4}, {}};
    case mesh::ElementShape::kWedge6:
      return {6, {0, 2, 1, 3, 5, 4}, {}};
    case mesh::ElementShape::kHex8:
      return {5, {0, 1, 2, 3, 4, 5, 6, 7}, {}};
    case mesh::ElementShape::kTet10:
      return {11, {0, 1, 2, 3}, tet};
    case mesh::ElementShape::kWedge15:
      return {18, {0, 2, 1, 3, 5, 4}, prism};
    case mesh::ElementShape::kHex20:
      break;
  }
  return {17, {0, 1, 2, 3, 4, 5, 6, 7}, hex};
}

/// Returns the nodes of an element in Gmsh's order.
inline std::vector<std::int32_t> in_gmsh_order(mesh::ElementShape shape,
                                               const std::int32_t* element) {
  const GmshPicture picture = gmsh_picture(shape);
  std::vector<std::int32_t> nodes;
  for (const int corner : picture.corners) nodes.push_back(element[corner]);
  for (const auto& [i, j] : picture.edges) {
    const std::pair<int, int> wanted =
        std::minmax(picture.corners[std::size_t(i)], picture.corners[std::size_t(j)]);
    int middle = mesh::corner_count(shape);
    for (const auto& [a, b] : mesh::edges_of(shape)) {
      if (std::pair<int, int>(std::minmax(a, b)) == wanted) nodes.push_back(element[middle]);
      ++middle;
    }
  }
  return nodes;
}

inline constexpr int kGmshFaceTypes[] = {2, 3, 9, 16};

/// One block of elements of a Gmsh file.
struct GmshElements {
  int dimension;
  int entity;
  int type;
  std::vector<std::vector<std::int32_t>> elements;  ///< Our node numbers, in Gmsh's order.
};

/// Returns the mesh as a Gmsh file: one volume entity and physical group per region, one surface
/// entity per face set, one point entity per node set. Node n has the tag 10 n + 3.
inline std::string gmsh_file(const mesh::VolumeMesh& mesh, GmshForm form) {
  std::vector<GmshElements> blocks;
  std::set<int> regions;
  for (const mesh::ElementBlock& block : mesh.blocks) {
    regions.insert(block.region.begin(), block.region.end());
    for (Index e = 0; e < block.element_count(); ++e)
      blocks.push_back({3,
                        100 + block.region[std::size_t(e)],
                        gmsh_picture(block.shape).type,
                        {in_gmsh_order(block.shape, block.element(e))}});
  }
  std::string names;
  int name_count = 0;
  const auto name = [&](int dimension, int tag, const std::string& text) {
    names += fmt::format("{} {} \"{}\"\n", dimension, tag, text);
    ++name_count;
  };
  for (const auto& [region, text] : mesh.region_names) name(3, region, text);
  int surface = 0, point = 0;
  for (const auto& [text, faces] : mesh.face_sets) {
    name(2, ++surface, text);
    for (const mesh::Face& face : faces) {
      std::vector<std::int32_t> nodes(nodes_of(face).begin(), nodes_of(face).end());
      const auto corners = mesh::corner_count(face.shape);  // Reversed, as faces of Gmsh may be.
      std::reverse(nodes.begin() + 1, nodes.begin() + corners);
      std::reverse(nodes.begin() + corners, nodes.end());
      blocks.push_back({2, surface, kGmshFaceTypes[int(face.shape)], {nodes}});
    }
  }
  for (const auto& [text, nodes] : mesh.node_sets) {
    if (mesh.face_sets.count(text) > 0) continue;
    name(0, ++point, text);
    for (const std::int32_t node : nodes) blocks.push_back({0, point, 15, {{node}}});
  }

  GmshNumbers entities(form);
  entities.size(std::uint64_t(point)).size(0).size(std::uint64_t(surface)).size(regions.size());
  for (int n = 1; n <= point; ++n) entities.whole(n).real(0).real(0).real(0).size(1).whole(n);
  const auto boxed = [&](int tag, int group) {
    entities.whole(tag);
    for (int c = 0; c < 6; ++c) entities.real(c);
    entities.size(1).whole(group).size(1).whole(-7);
  };
  for (int n = 1; n <= surface; ++n) boxed(n, -n);
  for (const int region : regions) boxed(100 + region, region);

  const auto tag = [](std::int32_t node) { return std::uint64_t(10 * node + 3); };
  GmshNumbers nodes(form);
  const auto count = mesh.nodes_L.size();
  nodes.size(2).size(count).size(3).size(tag(std::int32_t(count) - 1));
  // The first node has a parameter, as nodes on surfaces may; the last nodes are written first.
  nodes.whole(2).whole(1).whole(1).size(1).size(tag(0));
  for (int c = 0; c < 3; ++c) nodes.real(mesh.nodes_L[0][c]);
  nodes.real(0.5).real(0.25);
  nodes.whole(3).whole(1).whole(0).size(count - 1);
  for (std::size_t n = 1; n < count; ++n) nodes.size(tag(std::int32_t(n)));
  for (std::size_t n = 1; n < count; ++n)
    for (int c = 0; c < 3; ++c) nodes.real(mesh.nodes_L[n][c]);

  GmshNumbers elements(form);
  std::size_t total = 0;
  for (const GmshElements& block : blocks) total += block.elements.size();
  elements.size(blocks.size()).size(total).size(1).size(total);
  std::uint64_t number = 0;
  for (const GmshElements& block : blocks) {
    elements.whole(block.dimension).whole(block.entity).whole(block.type);
    elements.size(block.elements.size());
    for (const auto& element : block.elements) {
      elements.size(++number);
      for (const std::int32_t node : element) elements.size(tag(node));
    }
  }

  const int one = 1;
  const std::string endian(reinterpret_cast<const char*>(&one), sizeof one);
  const bool is_text = form == GmshForm::kText;
  return fmt::format(
      "$MeshFormat\n4.1 {} 8\n{}$EndMeshFormat\n$PhysicalNames\n{}\n{}$EndPhysicalNames\n"
      "$Entities\n{}\n$EndEntities\n$Nodes\n{}\n$EndNodes\n$Elements\n{}\n$EndElements\n",
      is_text ? 0 : 1, is_text ? "" : endian + "\n", name_count, names, entities.bytes(),
      nodes.bytes(), elements.bytes());
}

}  // namespace lefort::test
