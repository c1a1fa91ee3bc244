/// \file
/// Plans whose mandible autorotates to a gap between the teeth.
#include <lefort/anatomy/parametric_head.h>
#include <lefort/io/segmentation_file.h>
#include <lefort/io/volume_files.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/prepare/find_head_landmarks.h>
#include <lefort/plan/condylar_axis.h>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "support/temporary_folder.h"

namespace lefort::pipeline::test_close_jaws {
namespace {

/// A folder with a scan of the mean head.
class CloseJaws : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<test::TemporaryFolder>();
    const anatomy::LabeledScan scan = anatomy::scan_of(anatomy::ParametricHead({}), 2.0, 0.0, 1);
    ASSERT_TRUE(io::write_volume(*folder_ / "ct.nrrd", scan.ct));
    ASSERT_TRUE(io::write_segmentation(*folder_ / "labels.seg.nrrd", scan.labels));
  }
  static void TearDownTestSuite() { folder_.reset(); }

  /// A segment of the maxilla, below a plane at z, that moves up.
  static std::string maxilla(double up_mm, double below_mm = 0.0) {
    return fmt::format(
        R"({{"name": "maxilla",
             "osteotomy": {{"planes": [{{"point_mm": [0, 0, {}], "towards_segment": [0, 0, -1]}}]}},
             "path": {{"keyframes": [{{"translation_mm": [0, 0, {}]}}]}}}})",
        below_mm, up_mm);
  }

  /// The left half of the maxilla, cut from it.
  static std::string left_half(double up_mm) {
    return fmt::format(
        R"({{"name": "left", "cut_from": "maxilla",
             "osteotomy": {{"planes": [{{"point_mm": [0.3, 0, 0], "towards_segment": [1, 0, 0]}}]}},
             "path": {{"keyframes": [{{"translation_mm": [0, 0, {}]}}]}}}})",
        up_mm);
  }

  static std::string mandible(const std::string& autorotate, double forward_mm = 0.0) {
    return fmt::format(
        R"({{"name": "mandible", "osteotomy": {{"bone": "mandible"}},
             "path": {{"keyframes": [{{"autorotate": {}, "translation_mm": [0, {}, 0]}}]}}}})",
        autorotate, -forward_mm);
  }

  static Result<io::PlanText> read_segments(const std::string& segments) {
    const auto file = *folder_ / "plan.json";
    const std::string text = fmt::format(
        R"({{"lefort_plan": 1, "ct": "ct.nrrd", "segmentation": {{"labels": "labels.seg.nrrd"}},
          "landmarks": {{"Cdl-R": [-59, -20, -6], "Cdm-R": [-40, -20, -6], "Cdl-L": [59, -20, -6],
                         "Cdm-L": [40, -20, -6], "L1": [0, -87, -48], "L6-R": [-28, -63, -51],
                         "L6-L": [28, -63, -51]}},
          "segments": [{}]}})",
        segments);
    EXPECT_TRUE(io::write_text(file, text));
    return read_plan_of_scan(file, std::nullopt, StageCache(*folder_ / "cache"), Progress::none());
  }

  /// Reads a plan in which the maxilla moves up and the mandible follows.
  static Result<io::PlanText> read(double up_mm, const std::string& autorotate) {
    return read_segments(maxilla(up_mm) + "," + mandible(autorotate));
  }

  static double closing_deg(const io::PlanText& plan, std::size_t segment = 1) {
    const auto json = nlohmann::json::parse(plan.json);
    return json["segments"][segment]["path"]["keyframes"][0]["autorotate"]["closing_deg"]
        .get<double>();
  }

  static std::unique_ptr<test::TemporaryFolder> folder_;
};
std::unique_ptr<test::TemporaryFolder> CloseJaws::folder_;

/// Distance between the lower teeth, closed by an angle and then moved forward, and the skull, moved
/// up, by the functions that define the head.
double clearance_mm(double closing, double up_mm, double forward_mm = 0.0) {
  constexpr double kOnSurface_mm = 0.2, kStep_mm = 0.5;
  const anatomy::ParametricHead head({});
  const RigidTransform closed = plan::autorotation({{-49.5, -20, -6}, {49.5, -20, -6}}, closing);
  double nearest_mm = 1e9;
  for (double x = -35.0; x <= 35.0; x += kStep_mm)
    for (double y = -95.0; y <= -40.0; y += kStep_mm)
      for (double z = -58.0; z <= -46.0; z += kStep_mm)
        if (const Vec3 p(x, y, z); std::abs(head.mandible(p)) < kOnSurface_mm)
          nearest_mm = std::min(nearest_mm, -head.skull(closed * p - Vec3(0, forward_mm, up_mm)));
  return nearest_mm;
}

/// Where teeth touch in the scan, 1.25 voxels of 2 mm are missing between their surfaces
/// (separate_levels.h): the jaws may close that much further, but not less.
TEST_F(CloseJaws, TheMandibleClosesUntilTheTeethAreAtTheGap) {
  constexpr double kTooFar_mm = 2.5, kAccuracy_mm = 0.5, kGap_mm = 0.5, kOpen_deg = 4.0;
  for (const double up_mm : {0.0, 4.0}) {
    const auto plan = read(up_mm, R"({"gap_mm": 0.5, "to": "maxilla"})");
    ASSERT_TRUE(plan) << plan.error().message;
    const double closed = closing_deg(*plan);
    EXPECT_LT(clearance_mm(closed, up_mm), kGap_mm + kAccuracy_mm);
    EXPECT_GT(clearance_mm(closed, up_mm), kGap_mm - kTooFar_mm);
    EXPECT_GT(clearance_mm(closed - kOpen_deg, up_mm), kGap_mm + kAccuracy_mm);
  }
  const auto still = read(4.0, R"({"gap_mm": 0.5})"), rest = read(0.0, R"({"gap_mm": 0.5})");
  const auto impacted = read(4.0, R"({"gap_mm": 0.5, "to": "maxilla"})");
  ASSERT_TRUE(still && rest && impacted);
  EXPECT_EQ(closing_deg(*still), closing_deg(*rest));
  EXPECT_GT(closing_deg(*impacted), closing_deg(*rest) + 1.0);
}

TEST_F(CloseJaws, AnUnknownUpperJawIsNamed) {
  const auto plan = read(0.0, R"({"gap_mm": 0.5, "to": "midface"})");
  ASSERT_FALSE(plan);
  EXPECT_EQ(plan.error().code, ErrorCode::kPlanInvalid);
  EXPECT_NE(plan.error().message.find("no segment 'midface'"), std::string::npos);
}

void expect_invalid(const Result<io::PlanText>& plan, const std::string& says) {
  ASSERT_FALSE(plan) << says;
  EXPECT_EQ(plan.error().code, ErrorCode::kPlanInvalid);
  EXPECT_NE(plan.error().message.find(says), std::string::npos) << plan.error().message;
}

TEST_F(CloseJaws, ASegmentThatIsNoUpperJawIsNamed) {
  expect_invalid(read(0.0, R"({"gap_mm": 0.5, "to": "mandible"})"), "cannot close to itself");
  const std::string chin = R"({"name": "chin", "osteotomy": {"planes": [
      {"point_mm": [0, 0, -75], "towards_segment": [0, 0, -1]}], "anchor_points": [[0, -83, -95]]},
      "path": {"keyframes": [{"translation_mm": [0, 0, 0]}]}})";
  expect_invalid(read_segments(chin + "," + mandible(R"({"gap_mm": 0.5, "to": "chin"})")),
                 "'chin' contains no bone of the skull");
  expect_invalid(read(0.0, R"({"as": "mandible"})"), "no segment 'mandible' closes to a gap");
  expect_invalid(read(0.0, R"({"as": "mandible", "gap_mm": 0.5})"), "or as");
}

/// Both halves of a maxilla move as planned, whichever of them is named. The same pose in one or
/// two pieces gives the same angle; a half that stays holds the mandible back.
TEST_F(CloseJaws, BothHalvesOfAMaxillaMove) {
  constexpr double kSame_deg = 0.01, kFurther_deg = 1.0;
  const auto angle = [](const std::string& segments, std::size_t segment) {
    const auto plan = read_segments(segments);
    EXPECT_TRUE(plan) << plan.error().message;
    return plan ? closing_deg(*plan, segment) : 0.0;
  };
  const std::string to_right = mandible(R"({"gap_mm": 0.5, "to": "maxilla"})");
  const std::string to_left = mandible(R"({"gap_mm": 0.5, "to": "left"})");
  const double rest = angle(maxilla(0.0) + "," + to_right, 1);
  const double impacted = angle(maxilla(4.0) + "," + to_right, 1);
  const auto halves = [&](double right_mm, double left_mm, const std::string& mandible) {
    return angle(maxilla(right_mm) + "," + left_half(left_mm) + "," + mandible, 2);
  };
  EXPECT_NEAR(halves(4.0, 4.0, to_right), impacted, kSame_deg);
  const double right = halves(4.0, 0.0, to_right), left = halves(0.0, 4.0, to_right);
  EXPECT_LT(std::max(right, left), impacted - kFurther_deg);
  EXPECT_NEAR(std::min(right, left), rest, kSame_deg);
  EXPECT_EQ(halves(4.0, 0.0, to_left), right);
  EXPECT_EQ(angle(to_right + "," + maxilla(4.0), 0), impacted);  // The other order of the jaws.
}

/// Bone of the skull that the named segment does not contain stays where it is.
TEST_F(CloseJaws, OnlyTheSegmentMoves) {
  const auto rest = read(0.0, R"({"gap_mm": 0.5, "to": "maxilla"})");
  // The cut below the teeth frees the tips of the incisors and molars only.
  const auto tips =
      read_segments(maxilla(4.0, -47.5) + "," + mandible(R"({"gap_mm": 0.5, "to": "maxilla"})"));
  const auto whole = read(4.0, R"({"gap_mm": 0.5, "to": "maxilla"})");
  ASSERT_TRUE(rest && whole);
  ASSERT_TRUE(tips) << tips.error().message;
  EXPECT_LT(closing_deg(*tips), closing_deg(*whole) - 0.2);
  EXPECT_GT(closing_deg(*tips), closing_deg(*rest) - 0.01);
}

/// The gap is that of the final occlusion: a mandible that moves forward by 1 mm after the
/// autorotation closes to another angle, and its gap at that pose is the requested one.
TEST_F(CloseJaws, TheGapIsThatOfTheFinalOcclusionAndOthersTakeItsAngle) {
  constexpr double kTooFar_mm = 2.5, kAccuracy_mm = 0.5, kGap_mm = 0.5;
  for (const double forward_mm : {-5.0, -2.0, 0.0}) {
    const std::string first = mandible(R"({"gap_mm": 0.5, "to": "maxilla"})", forward_mm);
    const std::string chin = R"({"name": "chin", "cut_from": "mandible", "osteotomy": {"planes": [
        {"point_mm": [0, 0, -75], "towards_segment": [0, 0, -1]}]},
        "path": {"keyframes": [{"autorotate": {"as": "mandible"}, "translation_mm": [0, -4, 0]}]}})";
    const auto plan = read_segments(maxilla(0.0) + "," + first + "," + chin);
    ASSERT_TRUE(plan) << plan.error().message;
    const double closed = closing_deg(*plan);
    EXPECT_EQ(closing_deg(*plan, 2), closed);
    EXPECT_LT(clearance_mm(closed, 0.0, forward_mm), kGap_mm + kAccuracy_mm) << forward_mm;
    EXPECT_GT(clearance_mm(closed, 0.0, forward_mm), kGap_mm - kTooFar_mm) << forward_mm;
  }
}

}  // namespace
}  // namespace lefort::pipeline::test_close_jaws
