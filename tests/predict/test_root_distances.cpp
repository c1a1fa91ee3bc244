/// \file
/// Distances of cuts from teeth.
#include <lefort/predict/root_distances.h>

#include <gtest/gtest.h>

#include "support/shapes.h"

namespace lefort::predict::test_root_distances {
namespace {

/// A jaw of 40 mm and teeth of 1 mm voxels in it: the upper tooth reaches up to z = -4.5.
anatomy::ToothMap teeth() {
  anatomy::ToothMap map;
  map.grid.size = {41, 41, 41};
  map.grid.origin_L = Vec3(-20, -20, -20);
  map.values.assign(std::size_t(map.grid.voxel_count()), anatomy::Tooth::kNone);
  for (Index k = 0; k <= 15; ++k) map.at(20, 10, k) = anatomy::Tooth::kUpper;
  map.at(3, 20, 18) = anatomy::Tooth::kLower;
  return map;
}

/// Bone, and the mandible on the right of x = -15.
anatomy::LabelMap labels() {
  anatomy::LabelMap map{teeth().grid, {}};
  map.values.assign(std::size_t(map.grid.voxel_count()), anatomy::Tissue::kBone);
  for (Index k = 0; k < 41; ++k)
    for (Index j = 0; j < 41; ++j)
      for (Index i = 0; i < 5; ++i) map.at(i, j, k) = anatomy::Tissue::kMandible;
  return map;
}

/// Two bars, so that no face of the cut lies in both bones.
geometry::TriangleMesh skull() {
  return test::join(test::make_box({-20, -20, -20}, {-16, 20, 20}),
                    test::make_box({-14, -20, -20}, {20, 20, 20}));
}

std::vector<RootDistance> distances(double cut_z_mm, double within_mm) {
  const std::vector<plan::PlannedSegment> planned{
      {.osteotomy = {"maxilla", {{{0, 0, cut_z_mm}, {0, 0, -1}}}}, .cut = {}}};
  const auto cut = plan::cut_segments(skull(), planned);
  EXPECT_TRUE(cut) << cut.error().message;
  return root_distances(*cut, planned, labels(), teeth(), nullptr, within_mm);
}

/// The last voxel of the upper tooth has its center at z = -5, the lower tooth at -2; each counts
/// for the cut of its bone only.
TEST(RootDistances, AreThoseFromTheCutToTheClosestToothOfEachJaw) {
  const auto found = distances(1.5, 10.0);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].jaw, anatomy::Tooth::kUpper);
  EXPECT_NEAR(found[0].distance_mm, 6.5, 1e-9);
  EXPECT_LT((found[0].tooth_L - Vec3(0, -10, -5)).norm(), 1e-12);
  EXPECT_NEAR(found[1].distance_mm, 3.5, 1e-9);
  EXPECT_EQ(describe(found[1], 5.0),
            "the cut of 'maxilla' passes 3.5 mm from a lower tooth, at (-17, 0, -2); the limit is "
            "5 mm");
}

TEST(RootDistances, AreThoseOfAllPiecesOfASegmentThatIsCutAgain) {
  std::vector<plan::PlannedSegment> planned{
      {.osteotomy = {"maxilla", {{{0, 0, 1.5}, {0, 0, -1}}}}, .cut = {}},
      {.osteotomy = {"front", {{{0, 0, 0}, {0, -1, 0}}}}, .cut = {}, .cut_from = "maxilla"}};
  const auto cut = plan::cut_segments(skull(), planned);
  ASSERT_TRUE(cut) << cut.error().message;
  // The tooth at y = -10 is below the part of the first cut that the second segment took.
  const auto found = root_distances(*cut, planned, labels(), teeth(), nullptr, 10.0);
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found[0].segment, "maxilla");
  EXPECT_EQ(found[0].jaw, anatomy::Tooth::kUpper);
  EXPECT_NEAR(found[0].distance_mm, 6.5, 1e-9);
}

TEST(RootDistances, ThoseBeyondTheLimitAreNotReportedAndACutThroughATooth) {
  const auto near = distances(1.5, 5.0);
  ASSERT_EQ(near.size(), 1U);
  EXPECT_EQ(near[0].jaw, anatomy::Tooth::kLower);
  const auto through = distances(-10.0, 1.0);
  ASSERT_EQ(through.size(), 1U);
  EXPECT_NEAR(through[0].distance_mm, 0.0, 1e-9);
}

}  // namespace
}  // namespace lefort::predict::test_root_distances
