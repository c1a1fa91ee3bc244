#include <lefort/geometry/mesh_properties.h>
#include <lefort/mesh/combine_solids.h>
#include <lefort/plan/fragments.h>
#include <lefort/plan/perform_osteotomy.h>

#include <gtest/gtest.h>

#include <vector>

#include "support/shapes.h"

namespace lefort::plan::test_fragments {
namespace {

using geometry::TriangleMesh;

const TriangleMesh kBar = test::make_box({-10, -20, -10}, {10, 20, 10});

Result<OsteotomyResult> cut_in_front(const TriangleMesh& skull) {
  return perform_osteotomy(skull, {"front", {{{0, 0, 0}, {0, -1, 0}}}});
}

//   y -20       0
//      +--------+---------+    A hook on the segment that ends behind the plane: its end is held by
//      |        |         |    the segment alone.
//      +--------+---------+
//      +========+=+ hook, joined to the bar at y < -14
TriangleMesh bar_with_hook(double end_mm) {
  const std::vector<Vec3> profile{{-10, -20, 0}, {14, -20, 0}, {14, end_mm, 0}, {12, end_mm, 0},
                                  {12, -14, 0},  {10, -14, 0}, {10, 20, 0},     {-10, 20, 0}};
  return *mesh::make_prism(profile, Vec3::UnitZ(), -10.0, 10.0);
}

TEST(Fragments, PieceHeldByTheSegmentAloneMovesWithIt) {
  const auto bones = cut_in_front(bar_with_hook(3.0));
  ASSERT_TRUE(bones) << bones.error().message;
  ASSERT_EQ(bones->fragments.size(), 1u);
  const Fragment& end = bones->fragments[0];
  EXPECT_EQ(end.owner, FragmentOwner::kSegment);
  EXPECT_FALSE(end.is_within_cut);
  EXPECT_NEAR(end.volume_mm3, 2.0 * 3.0 * 20.0, 1e-6);
  EXPECT_TRUE(geometry::is_closed(bones->segment_L));
  EXPECT_EQ(geometry::connected_components(bones->segment_L).count, 1);
  EXPECT_EQ(geometry::connected_components(bones->remainder_L).count, 1);
  EXPECT_NEAR(bones->segment_volume_mm3 + bones->remainder_volume_mm3, bones->skull_volume_mm3,
              1e-6);
}

TEST(Fragments, LargePieceBehindTheCutStays) {
  const auto bones = cut_in_front(bar_with_hook(19.0));  // 0.76 ml: above min_piece_ml.
  ASSERT_TRUE(bones) << bones.error().message;
  EXPECT_TRUE(bones->fragments.empty());
  EXPECT_EQ(geometry::connected_components(bones->remainder_L).count, 2);
}

TEST(Fragments, IslandsBelongToTheNearerPart) {
  TriangleMesh skull = kBar;
  skull = test::join(skull, test::make_box({12, -18, 0}, {14, -16, 2}));    // Beside the segment.
  skull = test::join(skull, test::make_box({12, -8, 0}, {12.9, -7.1, 1}));  // Below 1 mm3.
  const auto bones = cut_in_front(skull);
  ASSERT_TRUE(bones) << bones.error().message;
  ASSERT_EQ(bones->fragments.size(), 2u);
  EXPECT_EQ(bones->fragments[0].owner, FragmentOwner::kSegment);
  EXPECT_EQ(bones->fragments[1].owner, FragmentOwner::kNone);
  EXPECT_NEAR(bones->left_out_volume_mm3, 0.9 * 0.9, 1e-9);
  EXPECT_NEAR(bones->segment_volume_mm3 + bones->remainder_volume_mm3 + bones->left_out_volume_mm3,
              bones->skull_volume_mm3, 1e-6);
  EXPECT_EQ(bones->segment_pieces, 1);
}

TEST(Fragments, LargeIslandIsABoneOfItsOwn) {
  const auto bones = perform_osteotomy(
      test::join(kBar, test::make_box({12, -19, -10}, {18, -10, 10})),  // 1.08 ml.
      {.segment = "front", .planes = {{{0, 0, 0}, {0, -1, 0}}}, .anchor_points_L = {{0, -20, 0}}});
  ASSERT_TRUE(bones) << bones.error().message;
  ASSERT_EQ(bones->fragments.size(), 1u);
  EXPECT_EQ(bones->fragments[0].owner, FragmentOwner::kRemainder);
}

//  Two pieces below a cap touch at one of its corners, where each has a vertex of its own.
TEST(Fragments, CapOfTwoPiecesThatTouchAtAPointIsStitched) {
  const TriangleMesh below =
      test::join(test::make_box({0, 0, 0}, {1, 1, 1}), test::make_box({1, 1, 0}, {2, 2, 1}));
  // Both tops, flipped, are faces of the bone above.
  TriangleMesh above =
      test::join(test::make_box({0, 0, 1}, {1, 1, 2}), test::make_box({1, 1, 1}, {2, 2, 2}));
  std::int32_t first = -1;
  for (std::int32_t v = 0; v < above.vertex_count(); ++v)
    if (above.vertices[std::size_t(v)] == Vec3(1, 1, 1)) {
      if (first < 0) first = v;
      for (auto& triangle : above.triangles)
        for (std::int32_t& corner : triangle)
          if (corner == v) corner = first;
    }
  ASSERT_TRUE(geometry::is_closed(above));
  const TriangleMesh whole = joined(below, above);
  EXPECT_TRUE(geometry::is_closed(whole));
  EXPECT_NEAR(geometry::signed_volume_mm3(whole), 4.0, 1e-12);
  EXPECT_NEAR(geometry::area_mm2(whole), 2.0 * 10.0, 1e-12);
}

}  // namespace
}  // namespace lefort::plan::test_fragments
