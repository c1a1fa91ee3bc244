#include <lefort/compare/compare_by_region.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "support/shapes.h"

namespace lefort::compare::test_compare_by_region {
namespace {

/// The face is a sheet of 40 x 40 mm that faces upwards. The half x > 0 is lifted by 3 mm; a
/// prediction lifts it by 2.5 mm.
geometry::TriangleMesh lifted_by(double height_mm) {
  geometry::TriangleMesh sheet = test::make_sheet(40.0, 40);
  for (Vec3& v : sheet.vertices)
    if (v.x() > 0.1) v.z() = height_mm;
  return sheet;
}

const RegionDifference& row(const std::vector<RegionDifference>& rows, const char* region) {
  const auto found = std::find_if(rows.begin(), rows.end(),
                                  [&](const RegionDifference& r) { return r.region == region; });
  EXPECT_NE(found, rows.end()) << region;
  return *found;
}

/// Landmarks of a nose and an upper lip in the plane of upright_sheet().
plan::Landmarks lip_landmarks() {
  return {{"N'", {0, -100, 50}},
          {"Sn", {0, -100, 5}},
          {"Stm", {0, -100, -5}},
          {"Ch-R", {-10, -100, -5}},
          {"Ch-L", {10, -100, -5}}};
}

/// 40 mm wide and high, 100 mm before the origin.
geometry::TriangleMesh upright_sheet() {
  geometry::TriangleMesh sheet = test::make_sheet(40.0, 40);
  for (Vec3& v : sheet.vertices) v = Vec3(v.x(), -100.0, v.y());
  return sheet;
}

TEST(CompareByRegion, MovedPartIsReportedSeparately) {
  const auto before = lifted_by(0.0), predicted = lifted_by(2.5);
  const geometry::Bvh actual(lifted_by(3.0));
  const auto regions = FaceRegions::from({}).value();
  const auto rows =
      compare_by_region(predicted, measure_difference(predicted, actual), actual, &before, regions);
  ASSERT_EQ(rows.size(), 2U) << "no landmarks, no regions";
  EXPECT_EQ(rows[0].region, "whole");
  EXPECT_NEAR(row(rows, "moved").face.median_mm, 0.5, 1e-9);
  EXPECT_NEAR(row(rows, "moved").baseline->median_mm, 3.0, 1e-9);
  EXPECT_LT(row(rows, "whole").face.mean_mm, 0.3);
  EXPECT_LT(row(rows, "whole").baseline->mean_mm, 1.6);
}

/// Another triangulation of the face before surgery gives the same moved part, except its edge.
TEST(CompareByRegion, MovedPartDoesNotDependOnTheTriangulation) {
  const auto predicted = lifted_by(2.5);
  const geometry::Bvh actual(lifted_by(3.0));
  const auto before = test::make_sheet(40.0, 23);
  const auto rows = compare_by_region(predicted, measure_difference(predicted, actual), actual,
                                      &before, FaceRegions::from({}).value());
  EXPECT_NEAR(row(rows, "moved").face.area_mm2, 800.0, 40.0);
  EXPECT_NEAR(row(rows, "moved").face.median_mm, 0.5, 1e-9);
}

/// Skin of the upper lip that moves down still belongs to the upper lip.
TEST(CompareByRegion, SkinKeepsItsRegion) {
  const geometry::TriangleMesh before = upright_sheet();
  geometry::TriangleMesh after = before;
  for (Vec3& v : after.vertices) v.z() -= 8.0;
  const auto regions = FaceRegions::from(lip_landmarks()).value();
  const geometry::Bvh other(after);
  const auto rows =
      compare_by_region(after, measure_difference(after, other), other, &before, regions);
  const RegionDifference& lip = row(rows, "upper lip");
  EXPECT_GT(lip.face.area_mm2, 150.0);
  EXPECT_DOUBLE_EQ(lip.face.area_mm2, lip.baseline->area_mm2);
}

/// Sliding along itself is a displacement, too, but not a distance between surfaces.
TEST(MovementByRegion, IsTheDisplacementOfEachVertex) {
  const geometry::TriangleMesh before = upright_sheet();
  std::vector<Vec3> displacement_mm;
  for (const Vec3& v : before.vertices)
    displacement_mm.push_back(std::abs(v.x()) < 12.0 && std::abs(v.z()) < 7.0 ? Vec3(0.0, -3.0, 4.0)
                                                                              : Vec3::Zero());
  const auto rows =
      movement_by_region(before, displacement_mm, FaceRegions::from(lip_landmarks()).value());
  EXPECT_EQ(rows[0].region, "whole");
  EXPECT_DOUBLE_EQ(row(rows, "whole").face.median_mm, 0.0);
  EXPECT_DOUBLE_EQ(row(rows, "upper lip").face.median_mm, 5.0);
  EXPECT_DOUBLE_EQ(row(rows, "upper lip").face.p99_mm, 5.0);
  EXPECT_DOUBLE_EQ(row(rows, "moved").face.max_mm, 5.0);
  EXPECT_NEAR(row(rows, "moved").face.area_mm2, 24.0 * 14.0, 40.0);
  for (const RegionDifference& one : rows) EXPECT_FALSE(one.baseline);
}

TEST(CompareByRegion, WithoutFaceBeforeSurgeryThereIsNoBaselineAndNoMovedPart) {
  const auto predicted = lifted_by(2.5);
  const geometry::Bvh actual(lifted_by(3.0));
  const auto rows = compare_by_region(predicted, measure_difference(predicted, actual), actual,
                                      nullptr, FaceRegions::from({}).value());
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_FALSE(rows[0].baseline);
}

}  // namespace
}  // namespace lefort::compare::test_compare_by_region
