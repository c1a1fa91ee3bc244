/// \file
/// Errors of faces by region, and the ratio rule.
#include <lefort/compare/compare_by_region.h>
#include <lefort/compare/face_error.h>
#include <lefort/compare/ratio_rule.h>
#include <lefort/geometry/transform_mesh.h>

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "support/shapes.h"

namespace lefort::compare::test_face_error {
namespace {

using geometry::TriangleMesh;

const RegionError& row_of(const std::vector<RegionError>& rows, const std::string& name) {
  for (const RegionError& row : rows)
    if (row.region == name) return row;
  throw std::out_of_range(name);
}

/// The signs fail if x, y, z or prediction and achieved are exchanged.
TEST(FaceError, OfAShiftedFaceIsTheShiftAlongItsNormal) {
  const TriangleMesh achieved_L = test::make_box({-200, -50, -200}, {200, 50, 200});
  TriangleMesh face_L;  // A sheet in front of it, 2 mm too far anterior.
  face_L.vertices = {{-10, -52, -10}, {10, -52, -10}, {10, -52, 10}, {-10, -52, 10}};
  face_L.triangles = {{0, 1, 2}, {0, 2, 3}};
  const std::vector<FaceRegion> region_of(4, FaceRegion::kChin);
  const auto rows = face_error(face_L, region_of, geometry::Bvh(achieved_L));
  ASSERT_EQ(rows.size(), 8U);
  for (const char* name : {"face", "lower face", "chin"}) {
    const RegionError& row = row_of(rows, name);
    EXPECT_NEAR(row.statistics.mean_mm, 2.0, 1e-12);
    EXPECT_NEAR(row.statistics.mean_signed_mm, 2.0, 1e-12);
    EXPECT_NEAR(row.statistics.fraction_below_1mm, 0.0, 1e-12);
    EXPECT_LT((row.mean_offset_mm - Vec3(0, -2, 0)).norm(), 1e-12);
  }
  EXPECT_EQ(row_of(rows, "nose").statistics.area_mm2, 0.0);
  EXPECT_TRUE(std::isnan(row_of(rows, "nose").mean_offset_mm.x()));
}

TEST(RatioRule, SkinFollowsTheClosestBoneByTheRatioOfItsRegion) {
  const TriangleMesh chin = test::make_box({-10, -60, -80}, {10, -40, -60});
  const TriangleMesh skull = test::make_box({-50, -60, 0}, {50, 60, 100});
  TriangleMesh skin_L;
  skin_L.vertices = {{0, -70, -70}, {0, -70, 50}, {5, -70, -70}};
  skin_L.triangles = {{0, 1, 2}};
  RigidTransform back = RigidTransform::Identity();
  back.translation() = Vec3(0, 5, 0);
  const std::vector<MovedBone> bones{{&chin, back}, {&skull, RigidTransform::Identity()}};
  const std::vector<FaceRegion> region_of{FaceRegion::kChin, FaceRegion::kNose,
                                          FaceRegion::kElsewhere};
  const TriangleMesh moved_L = apply_ratio_rule(skin_L, region_of, bones);
  EXPECT_LT((moved_L.vertices[0] - Vec3(0, -70 + 0.95 * 5, -70)).norm(), 1e-12);
  EXPECT_EQ(moved_L.vertices[1], skin_L.vertices[1]) << "the skull does not move";
  EXPECT_EQ(moved_L.vertices[2], skin_L.vertices[2]) << "no ratio elsewhere";
}

}  // namespace
}  // namespace lefort::compare::test_face_error
