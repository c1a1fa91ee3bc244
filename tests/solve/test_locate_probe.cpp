#include <lefort/solve/locate_probe.h>

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "support/box_mesh.h"

namespace lefort::solve::test_locate_probe {
namespace {

class LocateProbe : public testing::TestWithParam<mesh::ElementShape> {
 protected:
  mesh::VolumeMesh mesh_ = test::box_mesh(
      {.cells = {3, 2, 2}, .size_mm = {3, 2, 2}, .distortion = 0.15, .shape = GetParam()});
};
INSTANTIATE_TEST_SUITE_P(Shapes, LocateProbe,
                         testing::Values(mesh::ElementShape::kTet4, mesh::ElementShape::kPyramid5,
                                         mesh::ElementShape::kWedge6, mesh::ElementShape::kHex8,
                                         mesh::ElementShape::kTet10, mesh::ElementShape::kWedge15,
                                         mesh::ElementShape::kHex20),
                         [](const auto& tested) { return std::string(name_of(tested.param)); });

TEST_P(LocateProbe, AnAffineDisplacementIsReadExactly) {
  Mat3 G;
  G << 0.3, 0.1, -0.2, 0.0, 0.5, 0.4, -0.6, 0.2, 0.1;
  VectorX u(3 * mesh_.node_count());
  for (Index n = 0; n < mesh_.node_count(); ++n)
    u.segment<3>(3 * n) = G * mesh_.nodes_L[std::size_t(n)] + Vec3(1, 2, 3);
  std::mt19937 random(11);
  std::uniform_real_distribution<double> in(0.0, 1.0);
  for (int n = 0; n < 200; ++n) {
    const Vec3 p_L(3.0 * in(random), 2.0 * in(random), 2.0 * in(random));
    const auto place = locate_probe(mesh_, p_L);
    ASSERT_TRUE(place) << place.error().message;
    EXPECT_LT((displacement_of(*place, u) - (G * p_L + Vec3(1, 2, 3))).norm(), 1e-12);
  }
}

TEST_P(LocateProbe, FindsPointsFarFromTheOrigin) {
  for (const double offset_mm : {300.0, 10000.0}) {
    mesh::VolumeMesh mesh = mesh_;
    for (Vec3& p_L : mesh.nodes_L) p_L += Vec3(offset_mm, -offset_mm, offset_mm);
    std::mt19937 random(12);
    std::uniform_real_distribution<double> in(0.0, 1.0);
    for (int n = 0; n < 200; ++n) {
      const Vec3 p_L = Vec3(3.0 * in(random), 2.0 * in(random), 2.0 * in(random)) +
                       Vec3(offset_mm, -offset_mm, offset_mm);
      const auto place = locate_probe(mesh, p_L);
      ASSERT_TRUE(place) << place.error().message;
      Vec3 at_L = Vec3::Zero();
      for (std::size_t a = 0; a < place->nodes.size(); ++a)
        at_L += place->weights[a] * mesh.nodes_L[std::size_t(place->nodes[a])];
      EXPECT_LT((at_L - p_L).norm(), 1e-10 + 1e-14 * offset_mm);
    }
  }
}

TEST_P(LocateProbe, CornersAndFacesOfTheBodyBelongToIt) {
  for (const Vec3& p_L : {Vec3(0, 0, 0), Vec3(3, 2, 2), Vec3(1.5, 0, 1), Vec3(3, 0, 0.3)})
    EXPECT_TRUE(locate_probe(mesh_, p_L)) << p_L.transpose();
}

TEST_P(LocateProbe, ANodeHasWeightOne) {
  const auto place = locate_probe(mesh_, std::int32_t(7));
  ASSERT_TRUE(place);
  EXPECT_EQ(place->nodes, std::vector<std::int32_t>{7});
  EXPECT_EQ(place->at_L, mesh_.nodes_L[7]);
  const auto found = locate_probe(mesh_, mesh_.nodes_L[7]);
  ASSERT_TRUE(found);
  for (std::size_t a = 0; a < found->nodes.size(); ++a)
    EXPECT_NEAR(found->weights[a], found->nodes[a] == 7 ? 1.0 : 0.0, 1e-9);
}

TEST_P(LocateProbe, APointOutsideIsRejectedWithTheClosestNode) {
  const auto place = locate_probe(mesh_, Vec3(3.5, 2, 2));
  ASSERT_FALSE(place);
  EXPECT_NE(place.error().message.find("(3.500, 2.000, 2.000) mm lies in no element; the closest "
                                       "node is 35 at (3.000, 2.000, 2.000) mm"),
            std::string::npos)
      << place.error().message;
  EXPECT_FALSE(locate_probe(mesh_, std::int32_t(-1)));
  EXPECT_FALSE(locate_probe(mesh_, std::int32_t(mesh_.node_count())));
}

}  // namespace
}  // namespace lefort::solve::test_locate_probe
