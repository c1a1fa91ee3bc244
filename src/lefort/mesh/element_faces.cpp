#include <lefort/core/check.h>
#include <lefort/mesh/element_faces.h>

#include <cstddef>

namespace lefort::mesh {
namespace {

using Edge = std::array<std::int8_t, 2>;
constexpr FaceShape kTri3 = FaceShape::kTri3, kQuad4 = FaceShape::kQuad4;
constexpr FaceShape kTri6 = FaceShape::kTri6, kQuad8 = FaceShape::kQuad8;

// Sketches of the elements are in fem/elements. Face i of a tetrahedron lies opposite to corner i.
constexpr std::array<LocalFace, 4> kTetFaces{
    {{kTri3, {1, 2, 3}}, {kTri3, {0, 3, 2}}, {kTri3, {0, 1, 3}}, {kTri3, {0, 2, 1}}}};
constexpr std::array<LocalFace, 5> kPyramidFaces{{{kQuad4, {0, 3, 2, 1}},
                                                  {kTri3, {0, 1, 4}},
                                                  {kTri3, {1, 2, 4}},
                                                  {kTri3, {2, 3, 4}},
                                                  {kTri3, {3, 0, 4}}}};
constexpr std::array<LocalFace, 5> kWedgeFaces{{{kTri3, {0, 1, 2}},
                                                {kTri3, {3, 5, 4}},
                                                {kQuad4, {0, 3, 4, 1}},
                                                {kQuad4, {1, 4, 5, 2}},
                                                {kQuad4, {2, 5, 3, 0}}}};
constexpr std::array<LocalFace, 6> kHexFaces{{{kQuad4, {0, 4, 7, 3}},
                                              {kQuad4, {1, 2, 6, 5}},
                                              {kQuad4, {0, 1, 5, 4}},
                                              {kQuad4, {3, 7, 6, 2}},
                                              {kQuad4, {0, 3, 2, 1}},
                                              {kQuad4, {4, 5, 6, 7}}}};

constexpr std::array<Edge, 6> kTetEdges{{{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};
constexpr std::array<Edge, 8> kPyramidEdges{
    {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 4}, {1, 4}, {2, 4}, {3, 4}}};
constexpr std::array<Edge, 9> kWedgeEdges{
    {{0, 1}, {1, 2}, {2, 0}, {3, 4}, {4, 5}, {5, 3}, {0, 3}, {1, 4}, {2, 5}}};
constexpr std::array<Edge, 12> kHexEdges{{{0, 1},
                                          {1, 2},
                                          {2, 3},
                                          {3, 0},
                                          {4, 5},
                                          {5, 6},
                                          {6, 7},
                                          {7, 4},
                                          {0, 4},
                                          {1, 5},
                                          {2, 6},
                                          {3, 7}}};

/// \returns the same faces with mid-edge nodes appended.
template <std::size_t kFaces, std::size_t kEdges>
constexpr std::array<LocalFace, kFaces> with_middles(const std::array<LocalFace, kFaces>& faces,
                                                     const std::array<Edge, kEdges>& edges,
                                                     int corners_of_element) {
  std::array<LocalFace, kFaces> quadratic = faces;
  for (LocalFace& face : quadratic) {
    const auto corners = std::size_t(corner_count(face.shape));
    for (std::size_t side = 0; side < corners; ++side) {
      const std::int8_t from = face.nodes[side];
      const std::int8_t to = face.nodes[(side + 1) % corners];
      for (std::size_t e = 0; e < kEdges; ++e)
        if ((edges[e][0] == from && edges[e][1] == to) ||
            (edges[e][0] == to && edges[e][1] == from))
          face.nodes[corners + side] = std::int8_t(corners_of_element + int(e));
    }
    face.shape = face.shape == kTri3 ? kTri6 : kQuad8;
  }
  return quadratic;
}

constexpr auto kTet10Faces = with_middles(kTetFaces, kTetEdges, 4);
constexpr auto kWedge15Faces = with_middles(kWedgeFaces, kWedgeEdges, 6);
constexpr auto kHex20Faces = with_middles(kHexFaces, kHexEdges, 8);

}  // namespace

std::span<const LocalFace> faces_of(ElementShape shape) {
  switch (shape) {
    case ElementShape::kTet4:
      return kTetFaces;
    case ElementShape::kPyramid5:
      return kPyramidFaces;
    case ElementShape::kWedge6:
      return kWedgeFaces;
    case ElementShape::kHex8:
      return kHexFaces;
    case ElementShape::kTet10:
      return kTet10Faces;
    case ElementShape::kWedge15:
      return kWedge15Faces;
    case ElementShape::kHex20:
      return kHex20Faces;
  }
  LEFORT_CHECK(false);
  return {};
}

Face face_of(const std::int32_t* element, const LocalFace& local) {
  Face face{.shape = local.shape, .nodes = {}};
  for (std::size_t n = 0; n < std::size_t(node_count(local.shape)); ++n)
    face.nodes[n] = element[local.nodes[n]];
  return face;
}

std::span<const std::array<std::int8_t, 2>> edges_of(ElementShape shape) {
  switch (corner_count(shape)) {
    case 4:
      return kTetEdges;
    case 5:
      return kPyramidEdges;
    case 6:
      return kWedgeEdges;
    default:
      return kHexEdges;
  }
}

}  // namespace lefort::mesh
