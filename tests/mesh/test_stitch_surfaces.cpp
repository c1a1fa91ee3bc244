#include <lefort/geometry/mesh_properties.h>
#include <lefort/mesh/cut_surface.h>
#include <lefort/mesh/stitch_surfaces.h>

#include <gtest/gtest.h>

#include <array>

#include "support/shapes.h"

namespace lefort::mesh::test_stitch_surfaces {
namespace {

TEST(StitchSurfaces, UndoesACut) {
  const geometry::TriangleMesh torus = test::make_torus(10.0, 3.0, 48, 24);
  const std::array half_spaces{HalfSpace{{0, 0, 0}, {0.1, 1, 0}}, HalfSpace{{0, 0, 1}, {0, 0, 1}}};
  const auto cut = cut_surface(torus, half_spaces);
  ASSERT_TRUE(cut) << cut.error().message;
  const geometry::TriangleMesh whole = stitch_surfaces(cut->outside, cut->inside);
  EXPECT_TRUE(geometry::is_closed(whole));
  EXPECT_EQ(geometry::connected_components(whole).count, 1);
  EXPECT_EQ(geometry::euler_characteristic(whole), 0);
  EXPECT_EQ(Index(whole.vertices.size()), geometry::weld_vertices(whole).vertex_count());
  EXPECT_NEAR(geometry::area_mm2(whole), geometry::area_mm2(torus), 1e-9);
  EXPECT_NEAR(geometry::signed_volume_mm3(whole), geometry::signed_volume_mm3(torus), 1e-9);
}

TEST(StitchSurfaces, KeepsSeparateBodies) {
  const auto whole =
      stitch_surfaces(test::make_box({0, 0, 0}, {1, 1, 1}), test::make_box({2, 0, 0}, {3, 1, 1}));
  EXPECT_EQ(whole.vertex_count(), 16);
  EXPECT_EQ(whole.triangle_count(), 24);
}

TEST(StitchSurfaces, DoesNotStitchFacesOfTheSameOrientation) {
  const geometry::TriangleMesh box = test::make_box({0, 0, 0}, {1, 1, 1});
  EXPECT_EQ(stitch_surfaces(box, box).triangle_count(), 24);
}

TEST(StitchSurfaces, EmptySurfaceIsTheNeutralElement) {
  const geometry::TriangleMesh box = test::make_box({0, 0, 0}, {1, 1, 1});
  EXPECT_EQ(stitch_surfaces(box, {}).triangles, box.triangles);
  EXPECT_EQ(stitch_surfaces({}, box).triangle_count(), 12);
}

}  // namespace
}  // namespace lefort::mesh::test_stitch_surfaces
