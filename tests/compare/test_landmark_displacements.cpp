#include <lefort/compare/landmark_displacements.h>

#include <gtest/gtest.h>

#include "support/shapes.h"

namespace lefort::compare::test_landmark_displacements {
namespace {

/// A sheet that is stretched along x and lifted: its points are moved exactly.
TEST(LandmarkDisplacements, AreThoseOfTheSkin) {
  const geometry::TriangleMesh before = test::make_sheet(20.0, 10);
  geometry::TriangleMesh after = before;
  for (Vec3& v : after.vertices) v = Vec3(1.5 * v.x(), v.y(), v.z() + 2.0);
  const plan::Landmarks landmarks{{"Prn", {4.3, -2.1, 0.0}},
                                  {"Sn", {-6.0, 1.0, 1.0}},
                                  {"ANS", {0.0, 0.0, 0.0}},
                                  {"Ls", {0.0, 0.0, 6.0}}};
  const auto carried = displace_landmarks(landmarks, before, after);
  ASSERT_TRUE(carried) << carried.error().message;
  ASSERT_EQ(carried->size(), 2U) << "no landmark of bone, none that is off the skin";
  EXPECT_LT(((*carried)[0].point_L - Vec3(6.45, -2.1, 2.0)).norm(), 1e-12);
  EXPECT_LT(((*carried)[1].point_L - Vec3(-9.0, 1.0, 3.0)).norm(), 1e-12);
}

TEST(LandmarkDisplacements, RejectDifferentSurfaces) {
  const auto carried =
      displace_landmarks({}, test::make_sheet(20.0, 10), test::make_sheet(20.0, 11));
  ASSERT_FALSE(carried);
  EXPECT_EQ(carried.error().code, ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace lefort::compare::test_landmark_displacements
