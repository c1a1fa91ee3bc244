#include <lefort/compare/face_regions.h>

#include <gtest/gtest.h>

#include <algorithm>

namespace lefort::compare::test_face_regions {
namespace {

/// An upright face, anterior is -y.
plan::Landmarks face() {
  return {{"N'", {0, -100, 50}},    {"Prn", {0, -120, 10}},    {"Sn", {0, -105, 0}},
          {"Stm", {0, -103, -20}},  {"Li", {0, -105, -28}},    {"Pg'", {0, -100, -48}},
          {"Me'", {0, -90, -60}},   {"Ex-R", {-45, -80, 45}},  {"Ex-L", {45, -80, 45}},
          {"En-R", {-16, -92, 45}}, {"En-L", {16, -92, 45}},   {"Al-R", {-18, -102, 4}},
          {"Al-L", {18, -102, 4}},  {"Ch-R", {-25, -95, -20}}, {"Ch-L", {25, -95, -20}}};
}

FaceRegions regions_of(const plan::Landmarks& landmarks) {
  auto regions = FaceRegions::from(landmarks);
  EXPECT_TRUE(regions) << regions.error().message;
  return *std::move(regions);
}

TEST(FaceRegions, AreAtTheirLandmarks) {
  const FaceRegions regions = regions_of(face());
  EXPECT_TRUE(regions.missing().empty());
  EXPECT_EQ(regions.at({0, -120, 10}), FaceRegion::kNose);
  EXPECT_EQ(regions.at({10, -104, -10}), FaceRegion::kUpperLip);
  EXPECT_EQ(regions.at({-10, -104, -25}), FaceRegion::kLowerLip);
  EXPECT_EQ(regions.at({5, -98, -50}), FaceRegion::kChin);
  EXPECT_EQ(regions.at({-35, -85, 10}), FaceRegion::kRightCheek);
  EXPECT_EQ(regions.at({35, -85, 10}), FaceRegion::kLeftCheek);
  EXPECT_EQ(regions.at({0, -100, 80}), FaceRegion::kElsewhere);
  EXPECT_EQ(regions.at({0, 80, 10}), FaceRegion::kElsewhere) << "the back of the head";
}

/// The nose is narrower at the top; the points next to it belong to the cheeks.
TEST(FaceRegions, NoseIsNarrowerAtItsRoot) {
  const FaceRegions regions = regions_of(face());
  EXPECT_EQ(regions.at({19, -100, 2}), FaceRegion::kNose);
  EXPECT_EQ(regions.at({19, -100, 44}), FaceRegion::kLeftCheek);
}

/// The region of a point does not depend on the orientation of the head.
TEST(FaceRegions, RotateWithTheHead) {
  const Mat3 turn = Eigen::AngleAxisd(0.4, Vec3(1, 0.2, 0.3).normalized()).toRotationMatrix();
  plan::Landmarks turned = face();
  for (plan::Landmark& l : turned) l.point_L = turn * l.point_L + Vec3(5, 6, 7);
  const FaceRegions upright = regions_of(face()), leaning = regions_of(turned);
  for (const Vec3& p : {Vec3(0, -120, 10), Vec3(10, -104, -10), Vec3(5, -98, -50),
                        Vec3(-35, -85, 10), Vec3(0, 80, 10)})
    EXPECT_EQ(upright.at(p), leaning.at(turn * p + Vec3(5, 6, 7))) << p.transpose();
}

TEST(FaceRegions, AreOmittedAndReportedIfLandmarksAreMissing) {
  plan::Landmarks landmarks = face();
  std::erase_if(landmarks,
                [](const plan::Landmark& l) { return l.name == "Stm" || l.name == "En-R"; });
  const FaceRegions regions = regions_of(landmarks);
  EXPECT_EQ(regions.missing(),
            (std::vector<std::string>{"nose: En", "upper lip: Stm", "lower lip: Stm",
                                      "right cheek: En", "left cheek: En"}));
  EXPECT_EQ(regions.at({0, -120, 10}), FaceRegion::kElsewhere);
  EXPECT_EQ(regions.at({5, -98, -50}), FaceRegion::kChin);
  EXPECT_EQ(regions_of({}).missing(),
            std::vector<std::string>{"all regions: Sn, and N' or Po and Or"});
}

TEST(FaceRegions, RejectsExchangedSides) {
  plan::Landmarks landmarks = face();
  for (plan::Landmark& l : landmarks) l.point_L.x() = -l.point_L.x();
  const auto regions = FaceRegions::from(landmarks);
  ASSERT_FALSE(regions);
  EXPECT_EQ(regions.error().code, ErrorCode::kPlanInvalid);
}

}  // namespace
}  // namespace lefort::compare::test_face_regions
