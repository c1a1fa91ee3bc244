/// \file
/// The faces and edges of each element shape, by its local nodes.
#pragma once

#include <lefort/mesh/volume_mesh.h>

#include <array>
#include <cstdint>
#include <span>

namespace lefort::mesh {

/// How many of the nodes are corners; the first ones are. The others are middles of edges.
[[nodiscard]] constexpr int corner_count(ElementShape shape) {
  constexpr std::array<int, 7> kCounts{4, 5, 6, 8, 4, 6, 8};
  return kCounts[std::size_t(shape)];
}
[[nodiscard]] constexpr int corner_count(FaceShape shape) {
  constexpr std::array<int, 4> kCounts{3, 4, 3, 4};
  return kCounts[std::size_t(shape)];
}

/// A face by the local nodes of its element, counter-clockwise seen from outside the element; the
/// first node_count(shape) count.
struct LocalFace {
  FaceShape shape;
  std::array<std::int8_t, 8> nodes;
};

/// All faces of the shape. Those of quadratic shapes are those of the linear ones, in their order,
/// with the middles of the sides.
[[nodiscard]] std::span<const LocalFace> faces_of(ElementShape shape);

/// The same face by the mesh's node numbers.
/// \param element  the nodes of the element: ElementBlock::element().
[[nodiscard]] Face face_of(const std::int32_t* element, const LocalFace& local);

/// The corners at the two ends of each edge, in the order in which the quadratic element of the
/// family numbers the middles of the edges after its corners.
[[nodiscard]] std::span<const std::array<std::int8_t, 2>> edges_of(ElementShape shape);

}  // namespace lefort::mesh
