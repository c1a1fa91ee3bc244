#include <lefort/geometry/mesh_properties.h>
#include <lefort/mesh/convex_solid.h>

#include <gtest/gtest.h>

#include <array>

namespace lefort::mesh::test_convex_solid {
namespace {

const Box3 kBox(Vec3(-2, -3, -4), Vec3(2, 3, 4));

TEST(ConvexSolid, IsTheBoxWithoutHalfSpaces) {
  const geometry::TriangleMesh solid = convex_solid({}, kBox);
  EXPECT_EQ(solid.vertex_count(), 8);
  EXPECT_TRUE(geometry::is_closed(solid));
  EXPECT_NEAR(geometry::signed_volume_mm3(solid), 192.0, 1e-12);
}

TEST(ConvexSolid, HalvesTheBoxByAnyPlaneThroughItsCenter) {
  for (const Vec3& normal : {Vec3(0, 0, 1), Vec3(1, 2, 3), Vec3(-5, 0.1, 0.2), Vec3(3, 2, 0)}) {
    const std::array half_spaces{HalfSpace{Vec3::Zero(), normal}};
    EXPECT_NEAR(geometry::signed_volume_mm3(convex_solid(half_spaces, kBox)), 96.0, 1e-9);
  }
}

TEST(ConvexSolid, CutsOffACorner) {
  const std::array half_spaces{HalfSpace{Vec3(1, 3, 4), Vec3(1, 1, 1)}};
  const geometry::TriangleMesh solid = convex_solid(half_spaces, kBox);
  EXPECT_EQ(solid.vertex_count(), 4);
  EXPECT_NEAR(geometry::signed_volume_mm3(solid), 1.0 / 6.0, 1e-12);
}

TEST(ConvexSolid, AcceptsDuplicatePlanes) {
  const HalfSpace half{Vec3::Zero(), Vec3(1, 2, 3)};
  const std::array half_spaces{half, half, HalfSpace{half.point, 10.0 * half.normal}};
  EXPECT_NEAR(geometry::signed_volume_mm3(convex_solid(half_spaces, kBox)), 96.0, 1e-9);
}

TEST(ConvexSolid, IsEmptyIfTheHalfSpacesExcludeEachOtherOrTheBox) {
  const std::array separate{HalfSpace{Vec3(1, 0, 0), Vec3(1, 0, 0)},
                            HalfSpace{Vec3(0, 0, 0), Vec3(-1, 0, 0)}};
  EXPECT_TRUE(convex_solid(separate, kBox).triangles.empty());
  const std::array sheet{HalfSpace{Vec3(1, 0, 0), Vec3(1, 0, 0)},
                         HalfSpace{Vec3(1, 0, 0), Vec3(-1, 0, 0)}};
  EXPECT_TRUE(convex_solid(sheet, kBox).triangles.empty());
  const std::array beyond{HalfSpace{Vec3(9, 0, 0), Vec3(1, 0, 0)}};
  EXPECT_TRUE(convex_solid(beyond, kBox).triangles.empty());
}

}  // namespace
}  // namespace lefort::mesh::test_convex_solid
