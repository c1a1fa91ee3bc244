#include <lefort/geometry/mesh_properties.h>
#include <lefort/mesh/boundary_faces.h>
#include <lefort/mesh/box_grid.h>
#include <lefort/mesh/element_faces.h>
#include <lefort/mesh/match_faces_to_elements.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>

namespace lefort::mesh::test_element_faces {
namespace {

constexpr ElementShape kShapes[] = {
    ElementShape::kTet4,  ElementShape::kPyramid5, ElementShape::kWedge6, ElementShape::kHex8,
    ElementShape::kTet10, ElementShape::kWedge15,  ElementShape::kHex20};

VolumeMesh one_element(ElementShape shape) {
  VolumeMesh box = make_box(shape, {1, 1, 1}, Vec3::Ones());
  ElementBlock& block = box.blocks[0];
  block.nodes.resize(std::size_t(node_count(shape)));
  block.region.resize(1);
  return box;
}

TEST(ElementFaces, EncloseTheElementAndPointOutwards) {
  const double volumes[] = {1.0 / 6, 1.0 / 6, 0.5, 1.0, 1.0 / 6, 0.5, 1.0};
  for (const ElementShape shape : kShapes) {
    const VolumeMesh mesh = one_element(shape);
    const geometry::TriangleMesh surface{mesh.nodes_L, triangles_of(boundary_faces(mesh))};
    EXPECT_TRUE(geometry::is_closed(surface)) << name_of(shape);
    EXPECT_NEAR(geometry::signed_volume_mm3(surface), volumes[int(shape)], 1e-15) << name_of(shape);
  }
}

TEST(ElementFaces, MidEdgeNodesLieBetweenTheirCorners) {
  for (const ElementShape shape :
       {ElementShape::kTet10, ElementShape::kWedge15, ElementShape::kHex20}) {
    const VolumeMesh mesh = one_element(shape);
    for (const LocalFace& local : faces_of(shape)) {
      const Face face = face_of(mesh.blocks[0].element(0), local);
      const auto corners = std::size_t(corner_count(face.shape));
      const auto at = [&](std::size_t n) { return mesh.nodes_L[std::size_t(face.nodes[n])]; };
      for (std::size_t side = 0; side < corners; ++side)
        EXPECT_EQ(at(corners + side), 0.5 * (at(side) + at((side + 1) % corners)));
    }
  }
}

TEST(ElementFaces, EachEdgeBelongsToTwoFaces) {
  for (const ElementShape shape : kShapes) {
    std::multiset<std::pair<int, int>> sides;
    for (const LocalFace& local : faces_of(shape)) {
      const int corners = corner_count(local.shape);
      for (int side = 0; side < corners; ++side)
        sides.insert(std::minmax<int>(local.nodes[std::size_t(side)],
                                      local.nodes[std::size_t((side + 1) % corners)]));
    }
    for (const auto& [i, j] : edges_of(shape))
      EXPECT_EQ(sides.count(std::minmax<int>(i, j)), 2U) << name_of(shape);
    EXPECT_EQ(sides.size(), 2 * edges_of(shape).size());
  }
}

TEST(MatchFacesToElements, OrientsBoundaryFacesOutwards) {
  for (const ElementShape shape : kShapes) {
    const VolumeMesh mesh = make_box(shape, {2, 2, 2}, Vec3::Ones());
    const std::vector<Face> boundary = boundary_faces(mesh);
    std::vector<Face> turned = boundary;
    for (Face& face : turned)
      std::reverse(face.nodes.begin(), face.nodes.begin() + corner_count(face.shape));
    EXPECT_EQ(match_faces_to_elements(mesh, turned).value(), boundary) << name_of(shape);
  }
}

TEST(MatchFacesToElements, KeepsTheOrientationOfAnInteriorFace) {
  const VolumeMesh mesh = make_box(ElementShape::kHex8, {2, 1, 1}, Vec3::Ones());
  const Face towards_x{.shape = FaceShape::kQuad4, .nodes = {1, 4, 10, 7}};
  const Face back{.shape = FaceShape::kQuad4, .nodes = {1, 7, 10, 4}};
  for (const Face& given : {towards_x, back}) {
    const Face face = match_faces_to_elements(mesh, {&given, 1}).value()[0];
    const auto x = [&](std::size_t n) { return mesh.nodes_L[std::size_t(face.nodes[n])]; };
    const double direction = (x(1) - x(0)).cross(x(2) - x(0)).x();
    EXPECT_GT(given == towards_x ? direction : -direction, 0.0);
  }
}

TEST(MatchFacesToElements, RejectsFacesWithoutElementAndDuplicates) {
  const VolumeMesh mesh = make_box(ElementShape::kHex8, {1, 1, 1}, Vec3::Ones());
  const Face loose{.shape = FaceShape::kTri3, .nodes = {0, 1, 2}};
  EXPECT_EQ(match_faces_to_elements(mesh, {&loose, 1}).error().message,
            "the face with corners 0, 1, 2 belongs to no element");
  const Face bottom{.shape = FaceShape::kQuad4, .nodes = {0, 1, 3, 2}};
  const std::vector<Face> twice{bottom, bottom};
  EXPECT_EQ(match_faces_to_elements(mesh, twice).error().message,
            "the face with corners 0, 1, 3, 2 occurs twice");
}

}  // namespace
}  // namespace lefort::mesh::test_element_faces
