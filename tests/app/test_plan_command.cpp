/// \file
/// `lefort plan check` and `lefort landmarks`, as a user runs them.
#include <lefort/geometry/mesh_measures.h>
#include <lefort/io/landmarks_file.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/write_atomically.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <string>

#include "support/run_program.h"
#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace lefort::app {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::string quoted(const fs::path& path) { return "'" + path.string() + "'"; }

/// A bar of 20 x 40 x 20 mm; its front, 15 mm long, moves.
class PlanCommand : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(
        io::write_surface(folder_ / "bar.stl", test::make_box({-10, -20, -10}, {10, 20, 10})));
  }
  static json plan() {
    return json::parse(R"({
      "lefort_plan": 1,
      "landmarks": {"A": [0, -20, 5], "B": [0, 20, 5], "Prn": [0, -25, 5]},
      "segments": [{
        "name": "front",
        "osteotomy": {"planes": [{"point_mm": [0, -5, 0], "towards_segment": [0, -1, 0]}]},
        "path": {"steps": 4, "keyframes": [{"translation_mm": [0, 0, 3]}]}
      }],
      "field": {"resolution": 64, "band_mm": 4}
    })");
  }
  test::ProgramRun check(const json& plan, const std::string& more = "") {
    EXPECT_TRUE(io::write_text(folder_ / "plan.json", plan.dump()));
    return test::run_lefort("--quiet plan check " + quoted(folder_ / "plan.json") + " --skull " +
                            quoted(folder_ / "bar.stl") + " -o " + quoted(folder_ / "out") + " " +
                            more);
  }
  json result() { return json::parse(io::read_text(folder_ / "out/check.json", 1 << 24).value()); }
  test::TemporaryFolder folder_;
};

TEST_F(PlanCommand, AShiftAlongTheCutCanBeDone) {
  const auto run = check(plan());
  ASSERT_EQ(run.exit_code, 0) << run.error << run.out;
  const json found = result();
  EXPECT_TRUE(found["possible"]);
  EXPECT_TRUE(found["findings"].empty());
  const json& segment = found["segments"][0];
  EXPECT_NEAR(segment["volume_ml"].get<double>(), 6.0, 1e-6);
  EXPECT_NEAR(segment["cut_area_mm2"].get<double>(), 400.0, 10.0);
  // 3 mm of 20 stand over; what is within 1 mm of the edge counts as supported.
  EXPECT_NEAR(segment["supported_area_mm2"].get<double>(), 20.0 * 18.0, 15.0);
  EXPECT_NEAR(segment["largest_gap_mm"].get<double>(), 3.0, 0.3);
  for (const char* file :
       {"segment_front.vtp", "segment_front.tfm", "remainder.vtp", "cephalometry.csv",
        "landmarks_after.mrk.json", "pictures/plan_cut_front.png", "pictures/plan_after_front.png"})
    EXPECT_TRUE(fs::exists(folder_ / "out" / file)) << file;
  const auto moved = io::read_surface(folder_ / "out/segment_front.vtp").value();
  EXPECT_NEAR(geometry::bounding_box(moved).max().z(), 13.0, 1e-5);
}

TEST_F(PlanCommand, LandmarksGoWithTheBoneTheyLieOn) {
  ASSERT_EQ(check(plan(), "--no-pictures").exit_code, 0);
  EXPECT_FALSE(fs::exists(folder_ / "out/pictures"));
  const auto after = io::read_landmarks(folder_ / "out/landmarks_after.mrk.json").value();
  EXPECT_LT((*plan::find_landmark(after, "A") - Vec3(0, -20, 8)).norm(), 1e-9);
  EXPECT_EQ(*plan::find_landmark(after, "B"), Vec3(0, 20, 5));
  EXPECT_EQ(*plan::find_landmark(after, "Prn"), Vec3(0, -25, 5));  // Skin is for predictions.
}

TEST_F(PlanCommand, BoneInBoneIsFound) {
  json backwards = plan();
  backwards["segments"][0]["path"]["keyframes"][0]["translation_mm"] = {0, 2, 0};
  const auto run = check(backwards, "--no-pictures");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.out.find("front and remainder are in each other: at 100.0 %"), std::string::npos)
      << run.out;
  const json found = result();
  EXPECT_FALSE(found["possible"]);
  EXPECT_EQ(found["findings"][0]["kind"], "overlap");
  EXPECT_NEAR(found["overlaps"][0]["deepest_mm"].get<double>(), 2.0, 0.2);
  EXPECT_NEAR(found["overlaps"][0]["volume_ml"].get<double>(), 0.8, 0.1);
  EXPECT_EQ(check(backwards, "--no-pictures --overlap 3").exit_code, 0);
}

TEST_F(PlanCommand, GapsAndLostSupportAreFoundButNotInDistraction) {
  json forwards = plan();
  forwards["segments"][0]["path"]["keyframes"][0]["translation_mm"] = {0, -12, 0};
  const auto run = check(forwards, "--no-pictures");
  EXPECT_EQ(run.exit_code, 1);
  const json found = result();
  ASSERT_EQ(found["findings"].size(), 2U) << found.dump(2);
  EXPECT_EQ(found["findings"][0]["kind"], "gap");
  EXPECT_EQ(found["findings"][1]["kind"], "missing_support");
  EXPECT_NEAR(found["segments"][0]["largest_gap_mm"].get<double>(), 12.0, 1e-3);
  forwards["segments"][0]["path"] = {
      {"distraction", {{{"towards", {0, -1, 0}}, {"mm_per_day", 1}, {"days", 12}}}}};
  const auto distracted = check(forwards, "--no-pictures");
  EXPECT_EQ(distracted.exit_code, 0) << distracted.out << distracted.error;
  EXPECT_NEAR(result()["segments"][0]["largest_gap_mm"].get<double>(), 12.0, 1e-3);
}

TEST_F(PlanCommand, SegmentsAreCheckedAgainstEachOther) {
  json two = plan();
  two["segments"][0]["osteotomy"] = {
      {"planes", {{{"point_mm", {0, -5, 0}}, {"towards_segment", {0, -1, 0}}}}}};
  two["segments"][0]["path"]["keyframes"][0]["translation_mm"] = {0, 0, 0.5};
  two["segments"].push_back(two["segments"][0]);
  two["segments"][1]["name"] = "front-left";
  two["segments"][1]["from"] = "front";
  two["segments"][1]["osteotomy"]["planes"][0] = {{"point_mm", {0, 0, 0}},
                                                  {"towards_segment", {1, 0, 0}}};
  two["segments"][1]["path"]["keyframes"][0]["translation_mm"] = {-3, 0, 0.5};
  const auto run = check(two, "--no-pictures");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.out.find("front and front-left are in each other"), std::string::npos) << run.out;
  EXPECT_NEAR(result()["segments"][0]["volume_ml"].get<double>(), 3.0, 1e-6);
}

TEST_F(PlanCommand, WhatFailsIsOneLineAndLeavesNothingOlder) {
  ASSERT_EQ(check(plan(), "--no-pictures").exit_code, 0);
  json missing = plan();
  missing["segments"][0]["osteotomy"]["planes"][0]["point_mm"] = {0, -50, 0};
  const auto run = check(missing, "--no-pictures");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_EQ(run.message_lines(), 1) << run.error;
  EXPECT_NE(run.error.find("no bone lies inside its planes"), std::string::npos) << run.error;
  for (const char* file : {"check.json", "segment_front.vtp", "segment_front.tfm", "remainder.vtp"})
    EXPECT_FALSE(fs::exists(folder_ / "out" / file)) << file;
}

TEST_F(PlanCommand, APredictionOfSeveralSegmentsIsRefused) {
  json two = plan();
  two["segments"].push_back(two["segments"][0]);
  two["segments"][1]["name"] = "other";
  ASSERT_TRUE(io::write_text(folder_ / "plan.json", two.dump()));
  const auto run =
      test::run_lefort("predict " + quoted(folder_ / "plan.json") + " --ct " +
                       quoted(folder_ / "plan.json") + " -o " + quoted(folder_ / "out"));
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_EQ(run.message_lines(), 1) << run.error;
  EXPECT_NE(run.error.find("moves 2 segments, a prediction takes one"), std::string::npos)
      << run.error;
}

TEST_F(PlanCommand, LandmarksAreMeasuredAndConverted) {
  const plan::Landmarks before{{"S", {0, 70, 0}}, {"N", {0, 0, 0}}, {"A", {0, 0, -50}}};
  plan::Landmarks after = before;
  after[2].point_L.y() = -50.0;
  ASSERT_TRUE(io::write_landmarks(folder_ / "before.mrk.json", before));
  ASSERT_TRUE(io::write_landmarks(folder_ / "after.csv", after));
  const auto run =
      test::run_lefort("--json landmarks " + quoted(folder_ / "before.mrk.json") + " --after " +
                       quoted(folder_ / "after.csv") + " -o " + quoted(folder_ / "table.csv") +
                       " --save " + quoted(folder_ / "saved.mrk.json"));
  ASSERT_EQ(run.exit_code, 0) << run.error;
  const json table = json::parse(run.out)["measurements"];
  EXPECT_EQ(table[0]["measurement"], "SNA");
  EXPECT_NEAR(table[0]["before"].get<double>(), 90.0, 1e-9);
  EXPECT_NEAR(table[0]["after"].get<double>(), 135.0, 1e-9);
  EXPECT_TRUE(table[1]["before"].is_null());
  EXPECT_NE(io::read_text(folder_ / "table.csv", 10000)->find("90.000,135.000,45.000"),
            std::string::npos);
  EXPECT_EQ(io::read_landmarks(folder_ / "saved.mrk.json")->size(), 3U);

  const auto wrong = test::run_lefort("landmarks " + quoted(folder_ / "before.mrk.json") +
                                      " --save " + quoted(folder_ / "x.fcsv"));
  EXPECT_EQ(wrong.exit_code, 1);
  EXPECT_EQ(wrong.message_lines(), 1) << wrong.error;
  EXPECT_FALSE(fs::exists(folder_ / "x.fcsv"));
}

}  // namespace
}  // namespace lefort::app
