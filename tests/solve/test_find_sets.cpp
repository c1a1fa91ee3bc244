#include <lefort/solve/find_sets.h>

#include <gtest/gtest.h>

#include "support/box_mesh.h"

namespace lefort::solve::test_find_sets {
namespace {

using NodeList = std::vector<std::int32_t>;

std::string refusal_of(const SetChoice& choice) {
  const auto mesh = add_sets(test::box_mesh(), std::vector<SetChoice>{choice});
  return mesh ? std::string() : mesh.error().message;
}

TEST(FindSets, ABoxAPlaneAndNumbersSelectTheSameSide) {
  const mesh::VolumeMesh box = test::box_mesh({.cells = {2, 2, 3}, .size_mm = {2, 2, 3}});
  const auto mesh = add_sets(
      box,
      std::vector<SetChoice>{{"box", NodesInBox{Box3(Vec3(-1, -1, 2.9), Vec3(3, 3, 3.0))}},
                             {"plane", NodesOnPlane{Vec3(7, 8, 3), Vec3::UnitZ(), 1e-6}},
                             {"numbers", NodesByNumber{{35, 27, 28, 29, 30, 31, 32, 33, 34, 27}}},
                             {"corner", NodeNearest{Vec3(5, 5, 5)}},
                             {"all", NodesOfRegion{"0"}}});
  ASSERT_TRUE(mesh) << mesh.error().message;
  for (const char* set : {"box", "plane", "numbers"})
    EXPECT_EQ(find_nodes(*mesh, set).value(), box.node_sets.at("z1")) << set;
  EXPECT_EQ(find_nodes(*mesh, "corner").value(), NodeList{35});
  EXPECT_EQ(find_nodes(*mesh, "all").value().size(), 36U);
}

TEST(FindSets, FacesOfANodeSetAreTheBoundaryFacesWithinIt) {
  const mesh::VolumeMesh box = test::box_mesh({.cells = {2, 2, 3}, .size_mm = {2, 2, 3}});
  const auto faces = find_faces(box, "z1");
  ASSERT_TRUE(faces) << faces.error().message;
  Vec3 area = Vec3::Zero();
  for (const mesh::Face& face : *faces) {
    const auto at = [&](std::size_t a) { return box.nodes_L[std::size_t(face.nodes[a])]; };
    area += 0.5 * (at(1) - at(0)).cross(at(2) - at(0));
  }
  EXPECT_LT((area - 4.0 * Vec3::UnitZ()).norm(), 1e-12);  // Points out of the body.
}

TEST(FindSets, AMissingSetIsReportedWithTheKnownSets) {
  const auto nodes = find_nodes(test::box_mesh(), "top");
  ASSERT_FALSE(nodes);
  EXPECT_EQ(nodes.error().code, ErrorCode::kPlanInvalid);
  EXPECT_EQ(nodes.error().message,
            "there is no set top; the sets are: boundary, outside, x0, x1, y0, y1, z0, z1");
  EXPECT_FALSE(find_faces(test::box_mesh(), "top"));
}

TEST(FindSets, AMissingRegionIsReportedWithTheKnownRegions) {
  mesh::VolumeMesh mesh = test::box_mesh();
  mesh.blocks[0].region[3] = 7;
  EXPECT_EQ(find_region(mesh, "7").value(), 7);
  EXPECT_EQ(find_region(mesh, "8").error().message, "there is no region 8; the regions are: 0, 7");
  mesh.region_names[7] = "muscle";
  EXPECT_EQ(find_region(mesh, "muscle").value(), 7);
  EXPECT_EQ(find_region(mesh, "bone").error().message,
            "there is no region bone; the regions are: 0, 7 (muscle)");
  EXPECT_FALSE(find_region(mesh, "7 "));
  EXPECT_FALSE(find_region(mesh, "99999999999"));
}

TEST(FindSets, AnEmptySetOrATakenNameIsRejected) {
  EXPECT_EQ(refusal_of({"far", NodesInBox{Box3(Vec3(5, 5, 5), Vec3(6, 6, 6))}}),
            "sets.far: no node of an element lies there");
  EXPECT_EQ(refusal_of({"x0", NodeNearest{}}), "sets.x0: the mesh has a set of that name");
  EXPECT_NE(refusal_of({"odd", NodesByNumber{{27}}}).find("no element has node 27"),
            std::string::npos);
  EXPECT_NE(refusal_of({"odd", NodesOfRegion{"4"}}).find("no region 4"), std::string::npos);
}

TEST(FindSets, NodesOfNoElementBelongToNoSet) {
  mesh::VolumeMesh mesh = test::box_mesh();
  mesh.nodes_L.emplace_back(0.5, 0.5, 1.0);
  mesh.node_sets["z1"].push_back(27);
  const auto with = add_sets(
      mesh, std::vector<SetChoice>{{"plane", NodesOnPlane{Vec3(0, 0, 1), Vec3::UnitZ(), 1e-6}},
                                   {"near", NodeNearest{Vec3(0.5, 0.5, 1.0)}}});
  EXPECT_EQ(find_nodes(*with, "z1").value().size(), 9U);
  EXPECT_EQ(find_nodes(*with, "plane").value().size(), 9U);
  EXPECT_NE(find_nodes(*with, "near").value(), NodeList{27});
}

TEST(FindSets, ANodeSetInsideTheBodyHasNoFaces) {
  mesh::VolumeMesh mesh = test::box_mesh();
  mesh.node_sets["inner"] = {13};
  EXPECT_EQ(find_faces(mesh, "inner").error().message,
            "set inner has no face: no boundary face has all its nodes in it");
}

}  // namespace
}  // namespace lefort::solve::test_find_sets
