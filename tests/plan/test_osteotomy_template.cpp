#include <lefort/geometry/mesh_properties.h>
#include <lefort/geometry/rigid_motion.h>
#include <lefort/plan/osteotomy_template.h>
#include <lefort/plan/perform_osteotomy.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

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

/// A canal that descends along the line from Go to L6, medial to it.
NerveCanal canal_at(double side, double inside_mm, double top_mm) {
  NerveCanal canal{{}, 1.5};
  for (const double along_mm : {0.0, 8.0, 16.0, 30.0})
    canal.line_L.emplace_back(side * (45.0 - 0.8 * inside_mm - 0.6 * along_mm),
                              -10.0 + 0.6 * inside_mm - 0.8 * along_mm,
                              std::max(top_mm - along_mm, -56.0));
  return canal;
}

/// Distance of the wall of a canal from split and medial cut, posterior to the buccal cut.
double distance_of(const Osteotomy& cut, const NerveCanal& canal, bool is_left) {
  const CutPlane& buccal = cut.planes[is_left ? 1 : 0];
  const auto& region = cut.additional_regions[is_left ? 0 : 1].planes;
  const CutPlane &split = region[is_left ? 1 : 0], &medial = region[is_left ? 2 : 1];
  double distance_mm = 1e9;
  for (std::size_t i = 0; i + 1 < canal.line_L.size(); ++i)
    for (double t = 0.0; t <= 1.0; t += 0.05) {
      const Vec3 p = (1.0 - t) * canal.line_L[i] + t * canal.line_L[i + 1];
      if (buccal.normal_L.dot(p - buccal.point_L) > 0.0) continue;
      distance_mm = std::min({distance_mm, split.normal_L.dot(p - split.point_L),
                              medial.normal_L.dot(p - medial.point_L)});
    }
  return distance_mm - canal.radius_mm;
}

TEST(OsteotomyTemplate, SagittalSplitKeepsTheCanalsFree) {
  const NerveCanal right = canal_at(-1.0, 5.0, -40.0), left = canal_at(1.0, 6.0, -34.0);
  const Osteotomy before = made(OsteotomyTemplate::kSagittalSplit);
  EXPECT_LT(distance_of(before, right, false), 0.0);  // The split passes through it.
  EXPECT_LT(distance_of(before, left, true), 0.0);
  TemplateOptions options;
  options.canals = {left, right};  // The side is that of its position.
  const auto cut =
      make_osteotomy(OsteotomyTemplate::kSagittalSplit, "s", head_landmarks(), options);
  ASSERT_TRUE(cut) << cut.error().message;
  EXPECT_NEAR(distance_of(*cut, right, false), 2.0, 0.05);
  EXPECT_NEAR(distance_of(*cut, left, true), 2.0, 0.05);
  for (const NerveCanal& canal : options.canals)
    for (const Vec3& p : canal.line_L) EXPECT_TRUE(is_within(*cut, p)) << p.transpose();
  // Canals that are far away change nothing.
  options.canals = {canal_at(-1.0, 12.0, -45.0), canal_at(1.0, 12.0, -45.0)};
  const auto same =
      make_osteotomy(OsteotomyTemplate::kSagittalSplit, "s", head_landmarks(), options);
  ASSERT_TRUE(same);
  for (std::size_t n = 0; n < 3; ++n)
    for (std::size_t k = 0; k < before.additional_regions[n].planes.size(); ++k)
      EXPECT_EQ(same->additional_regions[n].planes[k].point_L,
                before.additional_regions[n].planes[k].point_L);
}

TEST(OsteotomyTemplate, SagittalSplitRefusesCanalsThatCannotBeFree) {
  const auto message_of = [](const std::vector<NerveCanal>& canals) {
    TemplateOptions options;
    options.canals = canals;
    const auto cut =
        make_osteotomy(OsteotomyTemplate::kSagittalSplit, "s", head_landmarks(), options);
    return cut ? std::string() : cut.error().message;
  };
  EXPECT_NE(message_of({canal_at(-1.0, 4.0, -40.0), canal_at(1.0, 6.0, -40.0)})
                .find("right canal lies too lateral"),
            std::string::npos);
  EXPECT_NE(message_of({canal_at(-1.0, 6.0, -40.0), canal_at(1.0, 6.0, -12.0)})
                .find("left canal reaches"),
            std::string::npos);
  EXPECT_NE(message_of({canal_at(-1.0, 6.0, -40.0)}).find("there is no left canal"),
            std::string::npos);
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
