/// \file
/// The finite-element mesh: nodes, elements of mixed shapes, a region per element, named sets.
#pragma once

#include <lefort/core/types.h>

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lefort::mesh {

/// Node numbering is that of the VTK cell of the same shape.
enum class ElementShape : std::uint8_t {
  kTet4,
  kPyramid5,
  kWedge6,
  kHex8,
  kTet10,
  kWedge15,
  kHex20
};

/// \param shape  of an element.
/// \returns the number of its nodes.
[[nodiscard]] constexpr int node_count(ElementShape shape) {
  constexpr std::array<int, 7> kCounts{4, 5, 6, 8, 10, 15, 20};
  return kCounts[std::size_t(shape)];
}

/// \param shape  of an element.
/// \returns "tet4", "pyramid5", ...
[[nodiscard]] constexpr std::string_view name_of(ElementShape shape) {
  constexpr std::array<std::string_view, 7> kNames{"tet4",  "pyramid5", "wedge6", "hex8",
                                                   "tet10", "wedge15",  "hex20"};
  return kNames[std::size_t(shape)];
}

/// Elements of one shape.
struct ElementBlock {
  ElementShape shape = ElementShape::kTet4;
  std::vector<std::int32_t> nodes;   ///< node_count(shape) per element, one after another.
  std::vector<std::int32_t> region;  ///< One per element; see VolumeMesh::region_names.

  [[nodiscard]] Index element_count() const { return Index(region.size()); }
  /// \param e  number of the element in this block.
  /// \returns its node_count(shape) nodes.
  [[nodiscard]] const std::int32_t* element(Index e) const {
    return nodes.data() + e * node_count(shape);
  }
};

/// Node numbering is that of the VTK cell of the same shape, counter-clockwise seen from outside:
/// the corners, then the mid-edge nodes.
enum class FaceShape : std::uint8_t { kTri3, kQuad4, kTri6, kQuad8 };

/// \param shape  of a face.
/// \returns the number of its nodes.
[[nodiscard]] constexpr int node_count(FaceShape shape) {
  constexpr std::array<int, 4> kCounts{3, 4, 6, 8};
  return kCounts[std::size_t(shape)];
}

/// One face of an element of any shape.
struct Face {
  FaceShape shape = FaceShape::kTri3;
  std::array<std::int32_t, 8> nodes{};  ///< The first node_count(shape) are used, the others 0.

  [[nodiscard]] friend bool operator==(const Face&, const Face&) = default;
};

/// \param face  must outlive the result.
/// \returns its node_count(face.shape) nodes.
[[nodiscard]] inline std::span<const std::int32_t> nodes_of(const Face& face) {
  return {face.nodes.data(), std::size_t(node_count(face.shape))};
}

/// A triangle by its corners, counter-clockwise seen from outside the mesh.
using Face3 = std::array<std::int32_t, 3>;

/// Elements of one or several shapes over common nodes.
struct VolumeMesh {
  std::vector<Vec3> nodes_L;  ///< [mm]
  std::vector<ElementBlock> blocks;
  std::map<std::int32_t, std::string> region_names;            ///< A region may have no name.
  std::map<std::string, std::vector<std::int32_t>> node_sets;  ///< Ascending node numbers.
  std::map<std::string, std::vector<Face>> face_sets;

  [[nodiscard]] Index node_count() const { return Index(nodes_L.size()); }
  [[nodiscard]] Index element_count() const {
    Index count = 0;
    for (const ElementBlock& block : blocks) count += block.element_count();
    return count;
  }
};

}  // namespace lefort::mesh
