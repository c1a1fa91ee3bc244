/// \file
/// The faces and edges of each element shape, by local node numbers.
#pragma once

#include <lefort/mesh/volume_mesh.h>

#include <array>
#include <cstdint>
#include <span>

namespace lefort::mesh {

/// \param shape  of the element.
/// \returns the number of corner nodes. They come first; the others are mid-edge nodes.
[[nodiscard]] constexpr int corner_count(ElementShape shape) {
  constexpr std::array<int, 7> kCounts{4, 5, 6, 8, 4, 6, 8};
  return kCounts[std::size_t(shape)];
}
/// \param shape  of the face.
/// \returns the number of corner nodes. They come first; the others are mid-edge nodes.
[[nodiscard]] constexpr int corner_count(FaceShape shape) {
  constexpr std::array<int, 4> kCounts{3, 4, 3, 4};
  return kCounts[std::size_t(shape)];
}

/// A face by the local node numbers of its element, counter-clockwise seen from outside the
/// element; the first node_count(shape) entries are used.
struct LocalFace {
  FaceShape shape;
  std::array<std::int8_t, 8> nodes;
};

/// \param shape  of the element.
/// \returns all faces of the shape. Quadratic shapes have the faces of the linear ones, in the same
/// order, with mid-edge nodes.
[[nodiscard]] std::span<const LocalFace> faces_of(ElementShape shape);

/// Converts local to global node numbers.
///
/// \param element  the nodes of the element: ElementBlock::element().
/// \param local    one of faces_of() the element's shape.
/// \returns the face by the node numbers of the mesh.
[[nodiscard]] Face face_of(const std::int32_t* element, const LocalFace& local);

/// \param shape  of the element.
/// \returns the end corners of each edge, in the order of the mid-edge nodes of the quadratic
/// element of the same family.
[[nodiscard]] std::span<const std::array<std::int8_t, 2>> edges_of(ElementShape shape);

}  // namespace lefort::mesh
