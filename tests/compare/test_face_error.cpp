/// \file
/// Errors of faces by region, the ratio rule, and regions without landmarks.
#include <lefort/compare/compare_by_region.h>
#include <lefort/compare/estimate_landmarks.h>
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

/// A head with a nose, upright, anterior is -y; the mandible ends at z = -70.
TriangleMesh head() {
  TriangleMesh skin_L = test::make_icosphere(1.0, 5);
  for (Vec3& v : skin_L.vertices) {
    const double nose = 20.0 * std::exp(-40.0 * (v - Vec3(0, -1, 0)).squaredNorm());
    v = v.cwiseProduct(Vec3(75, 95, 110)) + Vec3(0, -nose, 0);
  }
  return skin_L;
}

TriangleMesh bone() { return test::make_box({-30, -80, -70}, {30, 60, 60}); }

std::vector<FaceRegion> regions_of_head(const TriangleMesh& skin_L) {
  const auto landmarks = estimate_landmarks(skin_L, bone());
  EXPECT_TRUE(landmarks) << landmarks.error().message;
  const auto regions = FaceRegions::from(*landmarks);
  EXPECT_TRUE(regions) << regions.error().message;
  EXPECT_TRUE(regions->missing().empty());
  return regions_of(skin_L, nullptr, *regions);
}

TEST(EstimateLandmarks, EveryRegionIsFoundFromTopToBottom) {
  const TriangleMesh skin_L = head();
  const auto region_of = regions_of_head(skin_L);
  std::array<double, 7> height_mm{}, count{};
  for (std::size_t v = 0; v < region_of.size(); ++v) {
    height_mm[std::size_t(region_of[v])] += skin_L.vertices[v].z();
    ++count[std::size_t(region_of[v])];
    if (region_of[v] == FaceRegion::kLeftCheek) {
      EXPECT_GT(skin_L.vertices[v].x(), 0.0);
    }
    if (skin_L.vertices[v].y() > 0.0) {
      EXPECT_EQ(region_of[v], FaceRegion::kElsewhere);
    }
  }
  for (const FaceRegion region : kFaceRegions) {
    ASSERT_GT(count[std::size_t(region)], 3.0) << name_of(region);
    height_mm[std::size_t(region)] /= count[std::size_t(region)];
  }
  const auto height_of = [&](FaceRegion region) { return height_mm[std::size_t(region)]; };
  EXPECT_GT(height_of(FaceRegion::kNose), height_of(FaceRegion::kUpperLip));
  EXPECT_GT(height_of(FaceRegion::kUpperLip), height_of(FaceRegion::kLowerLip));
  EXPECT_GT(height_of(FaceRegion::kLowerLip), height_of(FaceRegion::kChin));
}

TEST(EstimateLandmarks, BoneWithoutALowerJawIsRejected) {
  const auto landmarks = estimate_landmarks(head(), test::make_box({-40, -80, -10}, {40, 60, 60}));
  ASSERT_FALSE(landmarks);
  EXPECT_EQ(landmarks.error().code, ErrorCode::kAnatomyMissing);
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
