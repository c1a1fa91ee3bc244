#include <lefort/geometry/mesh_properties.h>
#include <lefort/geometry/rigid_motion.h>
#include <lefort/plan/osteotomy_template.h>
#include <lefort/plan/perform_osteotomy.h>

#include <gtest/gtest.h>

#include "support/shapes.h"

namespace lefort::plan::test_osteotomy_template {
namespace {

using geometry::TriangleMesh;

/// A head of 140 x 180 x 190 mm, solid, with the landmarks of an adult; LPS, sella at the origin.
TriangleMesh solid_head() {
  TriangleMesh head = test::make_icosphere(1.0, 5);
  for (Vec3& v : head.vertices) v = Vec3(70 * v.x(), 90 * v.y() + 12, 95 * v.z());
  return head;
}

Landmarks head_landmarks() {
  return {{"N", {0, -66, 30}},       {"S", {0, 0, 0}},          {"ANS", {0, -70, -25}},
          {"PNS", {0, -25, -28}},    {"Or-R", {-32, -55, 2}},   {"Or-L", {32, -55, 2}},
          {"Po-R", {-58, 15, 2}},    {"Po-L", {58, 15, 2}},     {"FZ-R", {-48, -48, 26}},
          {"FZ-L", {48, -48, 26}},   {"Me", {0, -52, -72}},     {"Pg", {0, -60, -60}},
          {"Go-R", {-45, -10, -62}}, {"Go-L", {45, -10, -62}},  {"Co-R", {-50, 5, -5}},
          {"Co-L", {50, 5, -5}},     {"L6-R", {-24, -38, -45}}, {"L6-L", {24, -38, -45}}};
}

bool is_within(const std::vector<CutPlane>& planes, const Vec3& p) {
  for (const CutPlane& plane : planes)
    if (plane.normal_L.dot(p - plane.point_L) < 0.0) return false;
  return true;
}

bool is_within(const Osteotomy& cut, const Vec3& p) {
  if (is_within(cut.planes, p)) return true;
  for (const CutRegion& region : cut.additional_regions)
    if (is_within(region.planes, p)) return true;
  return false;
}

Osteotomy made(OsteotomyTemplate kind) {
  return make_osteotomy(kind, "s", head_landmarks()).value();
}

TEST(OsteotomyTemplate, LeFortOneMovesTheAlveolusAndNotTheOrbits) {
  const Osteotomy cut = made(OsteotomyTemplate::kLeFort1);
  EXPECT_EQ(cut.procedure, OsteotomyTemplate::kLeFort1);
  EXPECT_TRUE(is_within(cut, {0, -68, -30}));
  EXPECT_TRUE(is_within(cut, {28, -40, -24}));
  for (const Vec3& p : {Vec3(0, -66, -15), Vec3(32, -55, 2), Vec3(15, -10, -30)})
    EXPECT_FALSE(is_within(cut, p)) << p.transpose();
}

TEST(OsteotomyTemplate, LeFortTwoIsThePyramidOfTheNose) {
  const Osteotomy cut = made(OsteotomyTemplate::kLeFort2);
  for (const Vec3& p : {Vec3(0, -66, 22), Vec3(10, -60, 5), Vec3(-25, -40, -24)})
    EXPECT_TRUE(is_within(cut, p)) << p.transpose();
  for (const Vec3& p : {Vec3(0, -66, 36), Vec3(48, -48, 20), Vec3(-48, -48, 20), Vec3(0, -20, 10)})
    EXPECT_FALSE(is_within(cut, p)) << p.transpose();
}

TEST(OsteotomyTemplate, LeFortThreeMovesTheZygomasAndNotTheSkullBase) {
  const Osteotomy cut = made(OsteotomyTemplate::kLeFort3);
  for (const Vec3& p : {Vec3(0, -66, 22), Vec3(48, -47, 15), Vec3(-48, -47, 15), Vec3(0, -40, -20)})
    EXPECT_TRUE(is_within(cut, p)) << p.transpose();
  for (const Vec3& p : {Vec3(0, -66, 36), Vec3(48, -48, 32), Vec3(0, -30, 25), Vec3(50, -20, 0)})
    EXPECT_FALSE(is_within(cut, p)) << p.transpose();
}

TEST(OsteotomyTemplate, GenioplastyMovesTheChin) {
  const Osteotomy cut = made(OsteotomyTemplate::kGenioplasty);
  EXPECT_TRUE(is_within(cut, {0, -60, -60}));
  EXPECT_TRUE(is_within(cut, {0, -52, -72}));
  EXPECT_FALSE(is_within(cut, {0, -60, -50}));
  EXPECT_FALSE(is_within(cut, {45, -10, -62}));
}

TEST(OsteotomyTemplate, SagittalSplitMovesTeethAndLingualPlateAndNotTheCondyles) {
  const Osteotomy cut = made(OsteotomyTemplate::kSagittalSplit);
  for (const Vec3& p : {Vec3(0, -60, -60), Vec3(24, -38, -45), Vec3(-34, -12, -55)})
    EXPECT_TRUE(is_within(cut, p)) << p.transpose();
  for (const Vec3& p : {Vec3(50, 5, -5), Vec3(-45, -10, -62), Vec3(45, -11, -60)})
    EXPECT_FALSE(is_within(cut, p)) << p.transpose();
}

TEST(OsteotomyTemplate, EveryKindCutsAHeadIntoClosedPartsThatAddUp) {
  for (const auto kind :
       {OsteotomyTemplate::kLeFort1, OsteotomyTemplate::kLeFort2, OsteotomyTemplate::kLeFort3,
        OsteotomyTemplate::kGenioplasty, OsteotomyTemplate::kSagittalSplit}) {
    Osteotomy cut = made(kind);
    cut.anchor_points_L.clear();  // Landmarks of a head do not lie on an ellipsoid.
    const auto bones = perform_osteotomy(solid_head(), cut);
    ASSERT_TRUE(bones) << name_of(kind) << ": " << bones.error().message;
    EXPECT_TRUE(geometry::is_closed(bones->segment_L)) << name_of(kind);
    EXPECT_TRUE(geometry::is_closed(bones->remainder_L)) << name_of(kind);
    EXPECT_NEAR(bones->segment_volume_mm3 + bones->remainder_volume_mm3, bones->skull_volume_mm3,
                1e-3 * bones->skull_volume_mm3);
    cut.kerf_mm = 1.0;
    const auto sawn = perform_osteotomy(solid_head(), cut);
    ASSERT_TRUE(sawn) << name_of(kind) << ": " << sawn.error().message;
    EXPECT_NEAR(sawn->segment_volume_mm3, bones->segment_volume_mm3, 1e-6);
    EXPECT_GT(sawn->kerf_volume_mm3, 100.0);
    EXPECT_NEAR(sawn->segment_volume_mm3 + sawn->remainder_volume_mm3 + sawn->kerf_volume_mm3,
                sawn->skull_volume_mm3, 1e-3 * sawn->skull_volume_mm3);
  }
}

/// The cut of a rotated head is the rotated cut: templates use anatomical directions only.
TEST(OsteotomyTemplate, FollowsARotatedHead) {
  const RigidTransform X = geometry::rigid_motion({20, -5, 60}, {0.1, 0.2, 0.4}, {3, 4, 5});
  Landmarks turned = head_landmarks();
  for (Landmark& landmark : turned) landmark.point_L = X * landmark.point_L;
  for (const auto kind : {OsteotomyTemplate::kLeFort1, OsteotomyTemplate::kLeFort3,
                          OsteotomyTemplate::kSagittalSplit}) {
    const Osteotomy here = made(kind), there = make_osteotomy(kind, "s", turned).value();
    ASSERT_EQ(here.planes.size(), there.planes.size());
    for (std::size_t i = 0; i < here.planes.size(); ++i)
      EXPECT_LT((X.linear() * here.planes[i].normal_L - there.planes[i].normal_L).norm(), 1e-9);
  }
}

TEST(OsteotomyTemplate, ReportsAMissingLandmark) {
  Landmarks landmarks = head_landmarks();
  std::erase_if(landmarks, [](const Landmark& one) { return one.name == "FZ-L"; });
  const auto cut = make_osteotomy(OsteotomyTemplate::kLeFort3, "face", landmarks);
  ASSERT_FALSE(cut);
  EXPECT_EQ(cut.error().code, ErrorCode::kPlanInvalid);
  EXPECT_EQ(cut.error().message,
            "template le-fort-3 of 'face': landmark FZ-L (left frontozygomatic point) is missing");
  landmarks = head_landmarks();
  landmarks[3].point_L = landmarks[2].point_L;
  EXPECT_NE(make_osteotomy(OsteotomyTemplate::kLeFort1, "face", landmarks)
                .error()
                .message.find("less than 1 mm apart"),
            std::string::npos);
}

/// Exchanged landmarks would turn the head over, so that the segment would be the forehead.
TEST(OsteotomyTemplate, RejectsExchangedNames) {
  const auto refuse = [](const std::vector<std::pair<std::string, std::string>>& pairs,
                         const char* words) {
    Landmarks landmarks = head_landmarks();
    for (const auto& [a, b] : pairs)
      for (Landmark& one : landmarks) one.name = one.name == a ? b : one.name == b ? a : one.name;
    for (const auto kind : {OsteotomyTemplate::kLeFort1, OsteotomyTemplate::kLeFort3}) {
      const auto cut = make_osteotomy(kind, "face", landmarks);
      ASSERT_FALSE(cut) << words;
      EXPECT_EQ(cut.error().code, ErrorCode::kPlanInvalid);
      EXPECT_NE(cut.error().message.find(words), std::string::npos) << cut.error().message;
    }
  };
  refuse({{"Or-R", "Or-L"}}, "landmarks Or-R and Or-L");
  refuse({{"Or-R", "Or-L"},
          {"Po-R", "Po-L"},
          {"FZ-R", "FZ-L"},
          {"Go-R", "Go-L"},
          {"Co-R", "Co-L"},
          {"L6-R", "L6-L"}},
         "are they exchanged?");
  refuse({{"ANS", "PNS"}, {"Or-R", "Po-R"}, {"Or-L", "Po-L"}},
         "posterior to its anterior landmarks");
}

TEST(OsteotomyTemplate, PalateMustPointForwards) {
  Landmarks landmarks = head_landmarks();
  landmarks[3].point_L = landmarks[2].point_L + Vec3(30, 0, 0);  // PNS lateral to ANS.
  EXPECT_NE(make_osteotomy(OsteotomyTemplate::kLeFort1, "face", landmarks)
                .error()
                .message.find("on one transverse line"),
            std::string::npos);
}

TEST(OsteotomyTemplate, NamesConvertBothWays) {
  for (const char* name : {"le-fort-1", "le-fort-2", "le-fort-3", "genioplasty", "sagittal-split"})
    EXPECT_EQ(name_of(find_template(name).value()), name);
  EXPECT_FALSE(find_template("le-fort-4"));
}

}  // namespace
}  // namespace lefort::plan::test_osteotomy_template
