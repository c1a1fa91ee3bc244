/// \file
/// Cuts other than by unbounded planes: sheets, curves, several regions, cuts with a kerf.
#include <lefort/geometry/mesh_properties.h>
#include <lefort/plan/cut_segments.h>
#include <lefort/plan/perform_osteotomy.h>

#include <gtest/gtest.h>

#include <string>

#include "support/shapes.h"

namespace lefort::plan::test_cut_kinds {
namespace {

using geometry::signed_volume_mm3;
using geometry::TriangleMesh;

const TriangleMesh kBar = test::make_box({-10, -20, -10}, {10, 20, 10});  // 16 ml.

/// A simple skull: a shell of bone with a bar like a zygomatic arch.
TriangleMesh shell() {
  return test::join(test::make_icosphere(60.0, 5),
                    test::turn_inside_out(test::make_icosphere(50.0, 5)));
}

CutPlane sheet(const Vec3& point, const Vec3& normal, double width_mm, double height_mm) {
  return {point, normal, PlaneBounds{{1, 0, 0}, width_mm, height_mm}};
}

void expect_conserved(const Result<OsteotomyResult>& bones) {
  ASSERT_TRUE(bones) << bones.error().message;
  EXPECT_TRUE(geometry::is_closed(bones->segment_L));
  EXPECT_TRUE(geometry::is_closed(bones->remainder_L));
  EXPECT_NEAR(bones->segment_volume_mm3, signed_volume_mm3(bones->segment_L), 1e-6);
  EXPECT_NEAR(bones->segment_volume_mm3 + bones->remainder_volume_mm3 + bones->kerf_volume_mm3,
              bones->skull_volume_mm3, 1e-3 * bones->skull_volume_mm3);
}

void expect_error(const Result<OsteotomyResult>& bones, ErrorCode code, const std::string& words) {
  ASSERT_FALSE(bones) << words;
  EXPECT_EQ(bones.error().code, code) << bones.error().message;
  EXPECT_NE(bones.error().message.find(words), std::string::npos) << bones.error().message;
}

TEST(CutBySheets, SheetThroughTheBarSeparatesIt) {
  const auto bones = perform_osteotomy(kBar, {"front", {sheet({0, -5, 0}, {0, -1, 0}, 30, 30)}});
  expect_conserved(bones);
  EXPECT_NEAR(bones->segment_volume_mm3, 6000.0, 1e-3);
  EXPECT_NEAR(bones->remainder_volume_mm3, 10000.0, 1e-3);
  EXPECT_EQ(bones->kerf_volume_mm3, 0.0);
  EXPECT_EQ(geometry::connected_components(bones->remainder_L).count, 1);
  EXPECT_NEAR(geometry::bounding_box(bones->remainder_L).min().y(), -5.0, 1e-9);
}

TEST(CutBySheets, TooSmallASheetIsReported) {
  expect_error(perform_osteotomy(kBar, {"front", {sheet({0, -5, 0}, {0, -1, 0}, 30, 18)}}),
               ErrorCode::kCutMissesBone, "plane 0 does not separate the bone");
  expect_error(perform_osteotomy(kBar, {"front", {sheet({0, -50, 0}, {0, -1, 0}, 30, 18)}}),
               ErrorCode::kCutMissesBone, "cut no bone");
}

TEST(CutBySheets, CutsOnlyWithinItsBounds) {
  // Two separate bars; the sheet cuts one, an unbounded plane would cut both.
  const TriangleMesh two = test::join(kBar, test::make_box({30, -20, -10}, {50, 20, 10}));
  const auto bones = perform_osteotomy(two, {"front", {sheet({0, -5, 0}, {0, -1, 0}, 30, 30)}});
  expect_conserved(bones);
  EXPECT_NEAR(bones->segment_volume_mm3, 6000.0, 1e-3);
  const auto both = perform_osteotomy(two, {"front", {{{0, -5, 0}, {0, -1, 0}}}});
  ASSERT_TRUE(both);
  EXPECT_NEAR(both->segment_volume_mm3, 12000.0, 1e-6);
}

TEST(CutBySheets, SeveralSheetsSeparateOnePiece) {
  // A piece at the end of the bar, below z = 0 and in front of y = -5, by two sheets.
  const auto bones = perform_osteotomy(kBar, {"corner",
                                              {sheet({0, -12.5, 0}, {0, 0, -1}, 30, 15.2),
                                               sheet({0, -5, -5}, {0, -1, 0}, 30, 10.2)}});
  expect_conserved(bones);
  EXPECT_NEAR(bones->segment_volume_mm3, 20.0 * 15.0 * 10.0, 3.0);
}

TEST(CutBySheets, KerfIsRemoved) {
  Osteotomy osteotomy{"front", {sheet({0, -5, 0}, {0, -1, 0}, 30, 30)}};
  osteotomy.kerf_mm = 0.8;
  const auto bones = perform_osteotomy(kBar, osteotomy);
  expect_conserved(bones);
  EXPECT_NEAR(bones->kerf_volume_mm3, 20.0 * 20.0 * 0.8, 1e-3);
  EXPECT_NEAR(bones->segment_volume_mm3, 6000.0, 1e-3);
}

TEST(CutByPlanes, KerfIsRemovedFromTheRemainder) {
  Osteotomy osteotomy{"front", {{{0, -5, 0}, {0, -1, 0}}}};
  osteotomy.kerf_mm = 1.5;
  const auto bones = perform_osteotomy(kBar, osteotomy);
  expect_conserved(bones);
  EXPECT_NEAR(bones->segment_volume_mm3, 6000.0, 1e-6);
  EXPECT_NEAR(bones->kerf_volume_mm3, 400.0 * 1.5, 1e-6);
  EXPECT_NEAR(geometry::bounding_box(bones->remainder_L).min().y(), -3.5, 1e-9);
}

TEST(CutByPlanes, KerfIsNotRemovedNextToFragments) {
  const TriangleMesh with_spur = test::join(kBar, test::make_box({12, -7, 0}, {14, 18, 2}));
  Osteotomy osteotomy{"front", {{{0, -5, 0}, {0, -1, 0}}}};
  osteotomy.kerf_mm = 1.0;
  const auto bones = perform_osteotomy(with_spur, osteotomy);
  expect_conserved(bones);
  EXPECT_EQ(bones->fragments.size(), 1u);
  EXPECT_NEAR(bones->kerf_volume_mm3, 400.0, 1e-6);
  EXPECT_EQ(geometry::connected_components(bones->remainder_L).count, 2);  // The spur is not cut.
}

TEST(CutByCurve, WindowInAShellHasTheGivenDepth) {
  CutCurve window{{{-15, -80, -10}, {15, -80, -10}, {15, -80, 10}, {-15, -80, 10}}, {0, 1, 0}};
  const auto through = perform_osteotomy(shell(), {"both", {}, {window}});
  expect_conserved(through);
  EXPECT_EQ(through->segment_pieces, 2);  // Front and back of the shell.
  window.depth_mm = 60.0;
  const auto front = perform_osteotomy(shell(), {"front", {}, {window}});
  expect_conserved(front);
  EXPECT_EQ(front->segment_pieces, 1);
  EXPECT_NEAR(front->segment_volume_mm3, 0.5 * through->segment_volume_mm3,
              1e-3 * through->segment_volume_mm3);
  EXPECT_LT(geometry::bounding_box(front->segment_L).max().y(), -40.0);
}

TEST(CutByCurve, KerfSurroundsTheWindow) {
  const CutCurve window{{{-5, -80, -5}, {5, -80, -5}, {5, -80, 5}, {-5, -80, 5}}, {0, 1, 0}};
  Osteotomy osteotomy{"core", {}, {window}};
  osteotomy.kerf_mm = 1.0;
  const auto bones = perform_osteotomy(kBar, osteotomy);
  expect_conserved(bones);
  EXPECT_NEAR(bones->segment_volume_mm3, 100.0 * 40.0, 1e-6);
  EXPECT_NEAR(bones->kerf_volume_mm3, 44.0 * 40.0, 1e-6);
}

TEST(CutByRegions, AdditionalRegionsAreUnited) {
  Osteotomy osteotomy{"step", {{{0, -10, 0}, {0, -1, 0}}}};
  osteotomy.additional_regions = {{{{{0, 0, 0}, {0, -1, 0}}, {{0, 0, 0}, {0, 0, -1}}}, {}}};
  const auto bones = perform_osteotomy(kBar, osteotomy);
  expect_conserved(bones);
  EXPECT_EQ(bones->segment_pieces, 1);
  EXPECT_NEAR(bones->segment_volume_mm3, 4000.0 + 2000.0, 1e-6);
}

TEST(PerformOsteotomy, AnchorPointSelectsItsPiece) {
  const TriangleMesh two = test::join(kBar, test::make_box({30, -20, -10}, {50, 20, 10}));
  Osteotomy osteotomy{"front", {{{0, -5, 0}, {0, -1, 0}}}};
  osteotomy.anchor_points_L = {{40, -21, 0}};
  const auto bones = perform_osteotomy(two, osteotomy);
  expect_conserved(bones);
  EXPECT_NEAR(bones->segment_volume_mm3, 6000.0, 1e-6);
  EXPECT_GT(geometry::bounding_box(bones->segment_L).min().x(), 29.0);
  osteotomy.anchor_points_L = {{100, 0, 0}};
  expect_error(perform_osteotomy(two, osteotomy), ErrorCode::kCutMissesBone, "anchor point");
}

/// A spine behind a chin, both within the cut: the bound of fragments for the anchored piece does
/// not depend on the other piece.
TEST(PerformOsteotomy, AnchoredPieceMayBeSmallerThanAnotherOne) {
  const TriangleMesh chin = test::make_box({-5, -20, -5}, {5, 20, 5});
  const TriangleMesh spine = test::make_box({-30, 40, -200}, {30, 100, 10});
  Osteotomy osteotomy{"chin", {{{0, 0, -1}, {0, 0, -1}}}};
  osteotomy.anchor_points_L = {{0, -20, -5}};
  const auto bones = perform_osteotomy(test::join(chin, spine), osteotomy);
  expect_conserved(bones);
  EXPECT_NEAR(bones->segment_volume_mm3, 10.0 * 40.0 * 4.0, 1e-6);
  // The closest piece is taken, although a larger one is within the tolerance.
  const TriangleMesh near_spine = test::make_box({-30, 23, -200}, {30, 100, 10});
  osteotomy.anchor_points_L = {{0, 20, -3}};
  const auto nearest = perform_osteotomy(test::join(chin, near_spine), osteotomy);
  expect_conserved(nearest);
  EXPECT_NEAR(nearest->segment_volume_mm3, 10.0 * 40.0 * 4.0, 1e-6);
  // A piece below the volume bound is not taken.
  expect_error(perform_osteotomy(test::join(chin, spine), osteotomy, {.min_piece_ml = 2.0}),
               ErrorCode::kCutMissesBone, "no piece of 2 ml or more within the cut");
}

TEST(PerformOsteotomy, RejectsAKerfThatRemovesAllBone) {
  Osteotomy osteotomy{"front", {{{0, 17, 0}, {0, -1, 0}}}};
  osteotomy.kerf_mm = 5.0;
  expect_error(perform_osteotomy(kBar, osteotomy), ErrorCode::kCutMissesBone, "removes all bone");
  osteotomy.planes = {sheet({0, 17, 0}, {0, -1, 0}, 30, 30)};
  expect_error(perform_osteotomy(kBar, osteotomy), ErrorCode::kCutMissesBone, "removes all bone");
}

TEST(PerformOsteotomy, RejectsInvalidCuts) {
  Osteotomy mixed{"front", {sheet({0, -5, 0}, {0, -1, 0}, 30, 30), {{0, 0, 0}, {0, 0, 1}}}};
  expect_error(perform_osteotomy(kBar, mixed), ErrorCode::kPlanInvalid, "cannot be combined");
  expect_error(perform_osteotomy(kBar, {"front", {sheet({0, -5, 0}, {0, -1, 0}, 0, 30)}}),
               ErrorCode::kPlanInvalid, "its size is 0 x 30 mm");
  expect_error(perform_osteotomy(kBar, {"front", {sheet({0, -5, 0}, {1, 0, 0}, 5, 30)}}),
               ErrorCode::kPlanInvalid, "its width direction must not be parallel to its normal");
  expect_error(perform_osteotomy(kBar, {"front", {}, {{{{0, 0, 0}, {1, 0, 0}}, {0, 1, 0}}}}),
               ErrorCode::kPlanInvalid, "curve 0: the curve has 2 points");
  Osteotomy wide{"front", {{{0, -5, 0}, {0, -1, 0}}}};
  wide.kerf_mm = 9.0;
  expect_error(perform_osteotomy(kBar, wide), ErrorCode::kPlanInvalid,
               "the kerf of the saw is 9 mm");
}

PlannedSegment planned(Osteotomy osteotomy, std::string from = "") {
  return {std::move(osteotomy), {}, std::move(from), {}};
}

TEST(CutSegments, LaterCutsUseTheRemainderOrTheNamedSegment) {
  const std::vector<PlannedSegment> plan{
      planned({"front", {{{0, -5, 0}, {0, -1, 0}}}}), planned({"back", {{{0, 10, 0}, {0, 1, 0}}}}),
      planned({"front left", {{{0, 0, 0}, {1, 0, 0}}}}, "front")};
  const auto all = cut_segments(kBar, plan);
  ASSERT_TRUE(all) << all.error().message;
  ASSERT_EQ(all->segments_L.size(), 3U);
  EXPECT_NEAR(all->volumes_mm3[0], 3000.0, 1e-6);
  EXPECT_NEAR(all->volumes_mm3[1], 4000.0, 1e-6);
  EXPECT_NEAR(all->volumes_mm3[2], 3000.0, 1e-6);
  EXPECT_NEAR(all->remainder_volume_mm3, 6000.0, 1e-6);
  EXPECT_NEAR(all->skull_volume_mm3, 16000.0, 1e-6);
}

/// The bar is cut at y = 0 and -10: the middle is left between two ends, of which one moves.
TEST(CutPieces, APieceThatEarlierCutsLeftIsASegment) {
  const std::vector<PlannedSegment> plan{
      planned({"middle", {{{0, -10, 0}, {0, 1, 0}}, {{0, 5, 0}, {0, -1, 0}}}}),
      {.osteotomy = {"front", {}}, .cut = {}, .piece_at_L = Vec3(0, -20, 3)}};
  const auto all = cut_segments(kBar, plan);
  ASSERT_TRUE(all) << all.error().message;
  EXPECT_NEAR(all->volumes_mm3[0], 6000.0, 1e-3);
  EXPECT_NEAR(all->volumes_mm3[1], 4000.0, 1e-3);
  EXPECT_NEAR(all->remainder_volume_mm3, 6000.0, 1e-3);
  EXPECT_NEAR(geometry::bounding_box(all->segments_L[1]).max().y(), -10.0, 1e-9);
  EXPECT_TRUE(geometry::is_closed(all->segments_L[1]));
  EXPECT_TRUE(geometry::is_closed(all->remainder_L));
}

TEST(CutPieces, PiecesThatAreNotThereAreReported) {
  const auto refuse = [](std::vector<PlannedSegment> plan, const char* words) {
    const auto all = cut_segments(kBar, plan);
    ASSERT_FALSE(all) << words;
    EXPECT_EQ(all.error().code, ErrorCode::kCutMissesBone);
    EXPECT_NE(all.error().message.find(words), std::string::npos) << all.error().message;
  };
  const PlannedSegment front{.osteotomy = {"front", {}}, .cut = {}, .piece_at_L = Vec3(0, -20, 3)};
  PlannedSegment off = front;
  off.piece_at_L = Vec3(0, -26, 0);
  refuse({front}, "the bone is one piece");
  refuse({planned({"back", {{{0, 5, 0}, {0, 1, 0}}, {{0, 12, 0}, {0, -1, 0}}}}), off},
         "no piece of bone lies within 5 mm");
}

PlannedSegment whole_mandible(std::string name) {
  PlannedSegment segment = planned({std::move(name), {}});
  segment.is_whole_mandible = true;
  return segment;
}

TEST(CutSegments, TheMandibleMovesAsAWholeWithoutACut) {
  const TriangleMesh mandible = test::make_box({-10, -20, -30}, {10, 20, -20});
  const std::vector<PlannedSegment> plan{whole_mandible("mandible"),
                                         planned({"chin", {{{0, -5, 0}, {0, -1, 0}}}}, "mandible")};
  const auto all = cut_segments(kBar, &mandible, plan);
  ASSERT_TRUE(all) << all.error().message;
  EXPECT_NEAR(all->volumes_mm3[0], 5000.0, 1e-6);
  EXPECT_NEAR(all->volumes_mm3[1], 3000.0, 1e-6);
  EXPECT_NEAR(all->remainder_volume_mm3, 16000.0, 1e-6);
  EXPECT_NEAR(all->skull_volume_mm3, 24000.0, 1e-6);
  EXPECT_EQ(all->remainder_L.vertices, kBar.vertices);
  EXPECT_TRUE(takes_mandible(plan));
}

TEST(CutSegments, AMandibleThatIsNotThereIsNotTaken) {
  const auto refuse = [&](const TriangleMesh* mandible, const std::vector<PlannedSegment>& plan) {
    const auto all = cut_segments(kBar, mandible, plan);
    ASSERT_FALSE(all);
    EXPECT_EQ(all.error().code, ErrorCode::kAnatomyMissing);
  };
  refuse(nullptr, {whole_mandible("mandible")});
  refuse(&kBar, {whole_mandible("mandible"), whole_mandible("again")});
}

TEST(CutSegments, RejectsInvalidNames) {
  const Osteotomy cut{"front", {{{0, -5, 0}, {0, -1, 0}}}};
  const auto refuse = [&](const std::vector<PlannedSegment>& plan, const char* words) {
    const auto all = cut_segments(kBar, plan);
    ASSERT_FALSE(all) << words;
    EXPECT_EQ(all.error().code, ErrorCode::kPlanInvalid);
    EXPECT_NE(all.error().message.find(words), std::string::npos) << all.error().message;
  };
  refuse({planned(cut), planned(cut)}, "two segments are called 'front'");
  refuse({planned(cut, "front")}, "is cut from 'front', which is not an earlier segment");
}

}  // namespace
}  // namespace lefort::plan::test_cut_kinds
