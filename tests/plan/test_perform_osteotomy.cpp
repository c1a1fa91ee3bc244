#include <lefort/geometry/mesh_properties.h>
#include <lefort/plan/perform_osteotomy.h>

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "support/shapes.h"

namespace lefort::plan::test_perform_osteotomy {
namespace {

using geometry::TriangleMesh;

/// In front of the plane y = y_mm.
Osteotomy front_of(double y_mm) { return {"midface", {{{0.0, y_mm, 0.0}, {0.0, -1.0, 0.0}}}}; }

//   y -20       0        20     a bar of 40 x 20 x 20 mm = 16 ml, and next to it a
//      +--------+---------+     spur of 2 x 2 x 20 mm that starts at y = -2:
//      |       bar        |
//      +--------+---------+     front_of(0) cuts 8 ml off the bar, 0.008 ml off the spur
//              +=======+ spur
TriangleMesh bar_with_spur() {
  return test::join(test::make_box({-10, -20, -10}, {10, 20, 10}),
                    test::make_box({12, -2, 0}, {14, 18, 2}));
}

TEST(PerformOsteotomy, SeparatesTheBoneInFrontOfThePlane) {
  const auto bones =
      perform_osteotomy(test::make_box({-10, -20, -10}, {10, 20, 10}), front_of(-5.0));
  ASSERT_TRUE(bones) << bones.error().message;
  EXPECT_TRUE(geometry::is_closed(bones->segment_L));
  EXPECT_TRUE(geometry::is_closed(bones->remainder_L));
  EXPECT_NEAR(bones->segment_volume_mm3, 6000.0, 1e-6);
  EXPECT_NEAR(geometry::signed_volume_mm3(bones->segment_L), 6000.0, 1e-6);
  EXPECT_NEAR(geometry::signed_volume_mm3(bones->remainder_L), 10000.0, 1e-6);
  EXPECT_NEAR(bones->skull_volume_mm3, 16000.0, 1e-6);
  EXPECT_EQ(bones->segment_pieces, 1);
  EXPECT_TRUE(bones->fragments.empty());
  EXPECT_NEAR(geometry::bounding_box(bones->segment_L).max().y(), -5.0, 1e-12);
}

TEST(PerformOsteotomy, FragmentIsStitchedToTheRemainder) {
  const auto bones = perform_osteotomy(bar_with_spur(), front_of(0.0));
  ASSERT_TRUE(bones) << bones.error().message;
  EXPECT_EQ(bones->segment_pieces, 1);
  ASSERT_EQ(bones->fragments.size(), 1u);
  EXPECT_NEAR(bones->fragments[0].volume_mm3, 8.0, 1e-9);
  EXPECT_EQ(bones->fragments[0].owner, FragmentOwner::kRemainder);
  EXPECT_TRUE(bones->fragments[0].is_within_cut);
  EXPECT_NEAR(bones->segment_volume_mm3, 8000.0, 1e-6);
  EXPECT_NEAR(geometry::signed_volume_mm3(bones->segment_L), 8000.0, 1e-6);
  EXPECT_NEAR(geometry::signed_volume_mm3(bones->remainder_L), 8000.0 + 80.0, 1e-6);
  EXPECT_NEAR(bones->remainder_volume_mm3, 8000.0 + 80.0, 1e-6);
  EXPECT_TRUE(geometry::is_closed(bones->remainder_L));
  // The spur is one body again, without a cap at y = 0.
  const TriangleMesh spur = geometry::keep_components(
      bones->remainder_L, [](const TriangleMesh& part) { return part.vertices[0].x() > 11.0; });
  EXPECT_NEAR(geometry::area_mm2(spur), 2.0 * 4.0 + 4.0 * 40.0, 1e-9);
}

TEST(PerformOsteotomy, IslandBelongsToTheNearerPartWithItsCavity) {
  TriangleMesh skull = test::make_box({-10, -20, -10}, {10, 20, 10});
  skull = test::join(skull, test::make_box({12, -10, 0}, {16, -6, 4}));
  skull = test::join(skull, test::turn_inside_out(test::make_box({13, -9, 1}, {15, -7, 3})));
  const auto bones = perform_osteotomy(skull, front_of(0.0));
  ASSERT_TRUE(bones) << bones.error().message;
  ASSERT_EQ(bones->fragments.size(), 1u);
  EXPECT_NEAR(bones->fragments[0].volume_mm3, 64.0 - 8.0, 1e-9);
  EXPECT_EQ(bones->fragments[0].owner, FragmentOwner::kSegment);  // 2 mm away; the remainder 6 mm.
  EXPECT_NEAR(geometry::signed_volume_mm3(bones->segment_L), 8000.0 + 56.0, 1e-6);
  EXPECT_NEAR(bones->fragments[0].center_L.x(), 14.0, 1e-9);
}

TEST(PerformOsteotomy, BoundsDefineFragments) {
  const auto kept = perform_osteotomy(bar_with_spur(), front_of(0.0),
                                      {.min_piece_ml = 0.001, .min_piece_fraction = 1e-4});
  ASSERT_TRUE(kept) << kept.error().message;
  EXPECT_EQ(kept->segment_pieces, 2);
  EXPECT_TRUE(kept->fragments.empty());
  const auto by_fraction = perform_osteotomy(bar_with_spur(), front_of(0.0),
                                             {.min_piece_ml = 0.0, .min_piece_fraction = 0.01});
  ASSERT_TRUE(by_fraction) << by_fraction.error().message;
  EXPECT_EQ(by_fraction->fragments.size(), 1u);
}

void expect_error(const Result<OsteotomyResult>& bones, ErrorCode code, const std::string& words) {
  ASSERT_FALSE(bones);
  EXPECT_EQ(bones.error().code, code);
  EXPECT_NE(bones.error().message.find(words), std::string::npos) << bones.error().message;
}

TEST(PerformOsteotomy, ReportsPlanesThatMissTheBone) {
  const TriangleMesh skull = test::make_box({-10, -20, -10}, {10, 20, 10});
  expect_error(perform_osteotomy(skull, front_of(-25.0)), ErrorCode::kCutMissesBone,
               "'midface': no bone lies inside");
  expect_error(perform_osteotomy(skull, front_of(25.0)), ErrorCode::kCutMissesBone,
               "'midface': all bone lies inside");
  expect_error(perform_osteotomy(skull, front_of(-19.0)), ErrorCode::kCutMissesBone,
               "1 fragments of 0.4 ml");
}

TEST(PerformOsteotomy, RejectsAnOpenSkull) {
  TriangleMesh skull = test::make_box({-10, -20, -10}, {10, 20, 10});
  skull.triangles.pop_back();
  expect_error(perform_osteotomy(skull, front_of(0.0)), ErrorCode::kMeshInvalid, "open");
  expect_error(perform_osteotomy({}, front_of(0.0)), ErrorCode::kMeshInvalid, "");
}

TEST(PerformOsteotomy, RejectsAnInvalidPlan) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const TriangleMesh skull = test::make_box({-10, -20, -10}, {10, 20, 10});
  expect_error(perform_osteotomy(skull, {"midface", {}}), ErrorCode::kPlanInvalid,
               "`planes` is empty");
  expect_error(perform_osteotomy(skull, {"midface", {{Vec3::Zero(), Vec3::Zero()}}}),
               ErrorCode::kPlanInvalid, "plane 0: its normal");
  expect_error(perform_osteotomy(skull, {"midface", {{{0.0, kNan, 0.0}, {0.0, 1.0, 0.0}}}}),
               ErrorCode::kPlanInvalid, "plane 0: its point");
}

TEST(PerformOsteotomy, RejectsOptionsOutOfRange) {
  const TriangleMesh skull = test::make_box({-10, -20, -10}, {10, 20, 10});
  expect_error(perform_osteotomy(skull, front_of(0.0), {.min_piece_ml = -1.0}),
               ErrorCode::kInvalidArgument, "min_piece_ml");
  expect_error(perform_osteotomy(skull, front_of(0.0), {.min_piece_fraction = 1.5}),
               ErrorCode::kInvalidArgument, "min_piece_fraction");
}

}  // namespace
}  // namespace lefort::plan::test_perform_osteotomy
