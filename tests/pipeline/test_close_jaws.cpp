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

  /// Reads a plan in which the maxilla moves up and the mandible follows.
  static Result<io::PlanText> read(double up_mm, const std::string& autorotate) {
    const auto file = *folder_ / "plan.json";
    const std::string text = fmt::format(
        R"({{"lefort_plan": 1, "ct": "ct.nrrd", "segmentation": {{"labels": "labels.seg.nrrd"}},
          "landmarks": {{"Cdl-R": [-59, -20, -6], "Cdm-R": [-40, -20, -6], "Cdl-L": [59, -20, -6],
                         "Cdm-L": [40, -20, -6], "L1": [0, -87, -48], "L6-R": [-28, -63, -51],
                         "L6-L": [28, -63, -51]}},
          "segments": [
            {{"name": "maxilla",
              "osteotomy": {{"planes": [{{"point_mm": [0, 0, 0], "towards_segment": [0, 0, -1]}}]}},
              "path": {{"keyframes": [{{"translation_mm": [0, 0, {}]}}]}}}},
            {{"name": "mandible", "osteotomy": {{"bone": "mandible"}},
              "path": {{"keyframes": [{{"autorotate": {}}}]}}}}]}})",
        up_mm, autorotate);
    EXPECT_TRUE(io::write_text(file, text));
    return read_plan_of_scan(file, std::nullopt, StageCache(*folder_ / "cache"), Progress::none());
  }

  static double closing_deg(const io::PlanText& plan) {
    const auto json = nlohmann::json::parse(plan.json);
    return json["segments"][1]["path"]["keyframes"][0]["autorotate"]["closing_deg"].get<double>();
  }

  static std::unique_ptr<test::TemporaryFolder> folder_;
};
std::unique_ptr<test::TemporaryFolder> CloseJaws::folder_;

/// Distance between the lower teeth, closed by an angle, and the skull, moved up, by the functions
/// that define the head.
double clearance_mm(double closing, double up_mm) {
  constexpr double kOnSurface_mm = 0.2, kStep_mm = 0.5;
  const anatomy::ParametricHead head({});
  const RigidTransform closed = plan::autorotation({{-49.5, -20, -6}, {49.5, -20, -6}}, closing);
  double nearest_mm = 1e9;
  for (double x = -35.0; x <= 35.0; x += kStep_mm)
    for (double y = -95.0; y <= -40.0; y += kStep_mm)
      for (double z = -58.0; z <= -46.0; z += kStep_mm)
        if (const Vec3 p(x, y, z); std::abs(head.mandible(p)) < kOnSurface_mm)
          nearest_mm = std::min(nearest_mm, -head.skull(closed * p - Vec3(0, 0, up_mm)));
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

}  // namespace
}  // namespace lefort::pipeline::test_close_jaws
