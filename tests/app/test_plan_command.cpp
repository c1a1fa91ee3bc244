/// \file
/// `lefort plan check` and `lefort landmarks`, as a user runs them.
#include <lefort/geometry/mesh_properties.h>
#include <lefort/io/landmarks_file.h>
#include <lefort/io/read_text.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/write_atomically.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <string>
#include <vector>

#include "support/result_file.h"
#include "support/run_program.h"
#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace lefort::app::test_plan_command {
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
      "landmarks": {"A": [0, -20, 5], "B": [0, 20, 5], "Prn": [0, -25, 5], "PNS": [0, -5, 10],
                    "S": [0, 40, 5], "Ls": [0, -24, 0], "Sn": [0, -23, 2]},
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
  json result() { return test::read_result(folder_ / "out/check.json", "plan_check"); }
  test::TemporaryFolder folder_;
};

TEST_F(PlanCommand, ADeprecatedKeyIsReadWithOneWarning) {
  ASSERT_EQ(check(plan(), "--no-pictures").exit_code, 0);
  const json with_new_key = result();
  json old = plan();
  old["segments"][0]["path"]["keyframes"] =
      json::parse(R"([{"at": 0.5, "translation_mm": [0, 0, 1.5]},
                      {"at": 1, "translation_mm": [0, 0, 3]}])");
  const auto run = check(old, "--no-pictures");
  ASSERT_EQ(run.exit_code, 0) << run.error;
  const std::string warning =
      "warning: segments[].path.keyframes[].at is deprecated, use path_fraction\n";
  const std::size_t at = run.error.find(warning);
  ASSERT_NE(at, std::string::npos) << run.error;
  EXPECT_EQ(run.error.find("deprecated", at + warning.size()), std::string::npos) << run.error;
  EXPECT_EQ(result()["segments"], with_new_key["segments"]);
}

TEST_F(PlanCommand, AMovementAlongTheCutIsFeasible) {
  const auto run = check(plan());
  ASSERT_EQ(run.exit_code, 0) << run.error << run.out;
  const json found = result();
  EXPECT_FALSE(found["has_findings"]);
  EXPECT_TRUE(found["findings"].empty());
  const json& segment = found["segments"][0];
  EXPECT_NEAR(segment["volume_ml"].get<double>(), 6.0, 1e-6);
  EXPECT_NEAR(segment["cut_area_mm2"].get<double>(), 400.0, 10.0);
  // 3 mm of 20 stand over; what is within 1 mm of the edge counts as supported.
  EXPECT_NEAR(segment["supported_area_mm2"].get<double>(), 20.0 * 18.0, 15.0);
  EXPECT_NEAR(segment["max_gap_mm"].get<double>(), 3.0, 0.3);
  for (const char* file :
       {"segment_front.vtp", "segment_front.tfm", "remainder.vtp", "cephalometry.csv",
        "landmarks_after.mrk.json", "pictures/plan_cut_front.png", "pictures/plan_after_front.png"})
    EXPECT_TRUE(fs::exists(folder_ / "out" / file)) << file;
  const auto moved = io::read_surface(folder_ / "out/segment_front.vtp").value();
  EXPECT_NEAR(geometry::bounding_box(moved).max().z(), 13.0, 1e-5);
}

TEST_F(PlanCommand, LandmarksMoveWithTheirBone) {
  ASSERT_EQ(check(plan(), "--no-pictures").exit_code, 0);
  EXPECT_FALSE(fs::exists(folder_ / "out/pictures"));
  const auto after = io::read_landmarks(folder_ / "out/landmarks_after.mrk.json").value();
  EXPECT_LT((*plan::find_landmark(after, "A") - Vec3(0, -20, 8)).norm(), 1e-9);
  EXPECT_EQ(*plan::find_landmark(after, "B"), Vec3(0, 20, 5));
  // On the cut: both sides lie there, the segment takes it.
  EXPECT_LT((*plan::find_landmark(after, "PNS") - Vec3(0, -5, 13)).norm(), 1e-9);
}

TEST_F(PlanCommand, MovementsAreWrittenInTheTermsOfASurgeon) {
  ASSERT_EQ(check(plan()).exit_code, 0);
  const json movements = result()["movements"];
  ASSERT_EQ(movements.size(), 1U);
  EXPECT_EQ(movements[0]["segment"], "front");
  EXPECT_NEAR(movements[0]["center"]["superior_mm"].get<double>(), 3.0, 1e-9);
  EXPECT_NEAR(movements[0]["landmarks"]["A"]["superior_mm"].get<double>(), 3.0, 1e-9);
  EXPECT_FALSE(movements[0]["landmarks"].contains("B"));    // Not on the segment.
  EXPECT_FALSE(movements[0]["landmarks"].contains("Prn"));  // On the skin.
  const auto table = io::read_text(folder_ / "out/planned_movements.csv", 1 << 20).value();
  EXPECT_NE(table.find("front,A,0.000,0.000,3.000"), std::string::npos) << table;
  const auto sheet = io::read_text(folder_ / "out/worksheet.pdf", 1 << 24).value();
  EXPECT_TRUE(sheet.starts_with("%PDF-"));
}

TEST_F(PlanCommand, SplintsAndGuidesAreListedInTheWorksheet) {
  const auto sheet = [&] { return io::read_text(folder_ / "out/worksheet.pdf", 1 << 24).value(); };
  ASSERT_EQ(check(plan(), "--no-pictures").exit_code, 0);
  const std::string without = sheet();
  const json found = result();
  for (const char* folder : {"intermediate", "final", "guides"}) {
    fs::create_directories(folder_ / folder);
    ASSERT_TRUE(io::write_text(folder_ / folder / "splint.stl", folder));
  }
  const std::string splints = "--no-pictures --splint " +
                              quoted(folder_ / "intermediate/splint.stl") + " " +
                              quoted(folder_ / "final/splint.stl");
  ASSERT_EQ(check(plan(), splints).exit_code, 0);
  const std::string two = sheet();
  EXPECT_NE(two, without);
  EXPECT_EQ(result(), found);
  ASSERT_EQ(check(plan(), splints + " --guide " + quoted(folder_ / "guides/splint.stl")).exit_code,
            0);
  EXPECT_NE(sheet(), two);
  const auto run = check(plan(), "--no-pictures --guide " + quoted(folder_ / "none.stl"));
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_EQ(run.message_lines(), 1) << run.error;
  EXPECT_NE(run.error.find("none.stl"), std::string::npos) << run.error;
  EXPECT_EQ(result(), found);  // The earlier check is kept.
}

/// The cut is the plane y = -5; the right canal runs parallel to it, the left one crosses it.
TEST_F(PlanCommand, DistancesFromNervesAreReported) {
  json nerve = {{"lefort_nerve", 1}};
  for (int x = -8; x <= -2; ++x) nerve["right"]["points"].push_back({x, -1.0, 0.0});
  for (int y = -12; y <= 4; ++y) nerve["left"]["points"].push_back({5.0, y, 0.0});
  nerve["right"]["radius_mm"] = nerve["left"]["radius_mm"] = 1.5;
  const fs::path file = folder_ / "nerve.json";
  ASSERT_TRUE(io::write_text(file, nerve.dump()));
  const auto run = check(plan(), "--no-pictures --nerve " + quoted(file));
  EXPECT_EQ(run.exit_code, 1);  // A finding.
  const json found = result();
  ASSERT_EQ(found["nerve"].size(), 2U);
  EXPECT_EQ(found["nerve"][0]["nerve"], "right");
  EXPECT_NEAR(found["nerve"][0]["distance_mm"].get<double>(), 2.5, 1e-6);
  EXPECT_EQ(found["nerve"][1]["distance_mm"].get<double>(), 0.0);
  ASSERT_EQ(found["findings"].size(), 1U);
  EXPECT_EQ(found["findings"][0]["kind"], "nerve");
  EXPECT_NE(run.out.find("enters the canal of the left inferior alveolar nerve"), std::string::npos)
      << run.out;
  EXPECT_EQ(check(plan(), "--no-pictures --nerve-distance 3 --nerve " + quoted(file)).exit_code, 1);
  EXPECT_EQ(result()["findings"].size(), 2U);
  json wide = plan();  // The saw takes its kerf from the bone beside the segment.
  wide["segments"][0]["osteotomy"]["kerf_mm"] = 1.0;
  EXPECT_EQ(check(wide, "--no-pictures --nerve " + quoted(file)).exit_code, 1);
  EXPECT_NEAR(result()["nerve"][0]["distance_mm"].get<double>(), 1.5, 1e-6);

  for (const char* const bad :
       {"{", "{}", R"({"lefort_nerve": 1})", R"({"lefort_nerve": 1, "left": {"points": 3}})",
        R"({"lefort_nerve": 1, "left": {"radius_mm": 1, "points": [[1, 2]]}})",
        R"({"lefort_nerve": 1, "left": {"radius_mm": 1, "points": [[1, 2, 1e300]]}})",
        R"({"lefort_nerve": 1, "left": {"radius_mm": 1, "points": []}})",
        R"({"lefort_nerve": 1, "left": {"radius_mm": -1, "points": [[1, 2, 3], [2, 2, 3]]}})"}) {
    ASSERT_TRUE(io::write_text(file, bad));
    const auto refused = check(plan(), "--no-pictures --nerve " + quoted(file));
    EXPECT_EQ(refused.exit_code, 1) << bad;
    EXPECT_EQ(std::count(refused.error.begin(), refused.error.end(), '\n'), 1) << refused.error;
    EXPECT_NE(refused.error.find("make it with `lefort nerve`"), std::string::npos)
        << refused.error;
  }
}

/// Landmarks on the skin, or away from bone, are not reported as if they had not moved.
TEST_F(PlanCommand, LandmarksUnknownAfterSurgeryAreNotReported) {
  const auto run = check(plan(), "--no-pictures");
  ASSERT_EQ(run.exit_code, 0);
  const auto after = io::read_landmarks(folder_ / "out/landmarks_after.csv").value();
  for (const char* name : {"Prn", "Ls", "Sn", "S"})
    EXPECT_FALSE(plan::find_landmark(after, name)) << name;
  const json found = result();
  EXPECT_EQ(found["landmarks_off_bone"], json::array({"S"}));
  bool is_there = false;
  for (const json& line : found["cephalometry"]) {
    if (line["measurement"] != "PrnSnLs") continue;
    is_there = true;
    EXPECT_FALSE(line["before"].is_null());
    EXPECT_TRUE(line["after"].is_null()) << line;
  }
  EXPECT_TRUE(is_there);
  EXPECT_NE(run.out.find("in the frame of the landmarks before surgery"), std::string::npos)
      << run.out;
}

/// What stands in the output folder and is not of a check stays, bit for bit.
TEST_F(PlanCommand, FilesOfTheUserAreNeverRemoved) {
  fs::create_directories(folder_ / "out/plan_old");
  const std::vector<std::string> mine{"plan_anna.json", "segment_midface.vtp", "segment_notes.txt",
                                      "plan_old/plan_cut_front.png"};
  for (const std::string& name : mine) ASSERT_TRUE(io::write_text(folder_ / "out" / name, name));
  for (int run = 0; run < 2; ++run) {
    ASSERT_EQ(check(plan(), "--no-pictures").exit_code, 0);
    for (const std::string& name : mine)
      EXPECT_EQ(io::read_text(folder_ / "out" / name, 100).value_or("gone"), name);
  }
  // Nor if a list says that they are ours.
  json listed = result();
  listed["files"] = {"plan_anna.json", "../plan.json", "segment_notes.txt", "/etc/passwd",
                     "pictures/../plan_anna.json"};
  ASSERT_TRUE(io::write_text(folder_ / "out/check.json", listed.dump()));
  for (const char* name : {"segment_front.vtp", "segment_front.tfm", "remainder.vtp",
                           "cephalometry.csv", "landmarks_after.csv", "landmarks_after.mrk.json",
                           "planned_movements.csv", "worksheet.pdf"})
    fs::remove(folder_ / "out" / name);
  ASSERT_EQ(check(plan(), "--no-pictures").exit_code, 0);
  for (const std::string& name : mine) EXPECT_TRUE(fs::exists(folder_ / "out" / name)) << name;
  EXPECT_TRUE(fs::exists(folder_ / "plan.json"));
}

TEST_F(PlanCommand, WhatWouldBeOverwrittenIsNamed) {
  const auto refuse = [&](const test::ProgramRun& run, const char* name) {
    EXPECT_EQ(run.exit_code, 1) << name;
    EXPECT_EQ(run.message_lines(), 1) << run.error;
    EXPECT_NE(run.error.find(name), std::string::npos) << run.error;
    EXPECT_NE(run.error.find("choose another output folder"), std::string::npos) << run.error;
  };
  fs::create_directories(folder_ / "out");
  for (const char* name : {"check.json", "segment_front.vtp", "landmarks_after.csv"}) {
    ASSERT_TRUE(io::write_text(folder_ / "out" / name, "mine"));
    refuse(check(plan(), "--no-pictures"), name);
    EXPECT_EQ(io::read_text(folder_ / "out" / name, 100).value(), "mine");
    fs::remove(folder_ / "out" / name);
  }
}

/// Plan, skull and landmarks of the next stage stand where the last one wrote its results.
TEST_F(PlanCommand, InputsAmongEarlierResultsAreKept) {
  ASSERT_EQ(check(plan(), "--no-pictures").exit_code, 0);
  const auto bytes = [&](const char* name) {
    return io::read_text(folder_ / "out" / name, 1 << 24).value_or("gone");
  };
  const std::string skull = bytes("remainder.vtp"), landmarks = bytes("landmarks_after.csv");
  json second = plan();
  second["segments"][0]["osteotomy"]["planes"][0]["point_mm"] = {0, 5, 0};
  ASSERT_TRUE(io::write_text(folder_ / "out/plan_two.json", second.dump()));
  const std::string here = quoted(folder_ / "out");
  const auto run = test::run_lefort("--quiet plan check " + quoted(folder_ / "out/plan_two.json") +
                                    " --skull " + quoted(folder_ / "out/../out/remainder.vtp") +
                                    " -o " + here + " --no-pictures");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_EQ(run.message_lines(), 1) << run.error;
  EXPECT_NE(run.error.find("remainder.vtp is an input of this check"), std::string::npos)
      << run.error;
  second["landmarks"] = "landmarks_after.csv";
  ASSERT_TRUE(io::write_text(folder_ / "out/plan_two.json", second.dump()));
  const auto again =
      test::run_lefort("--quiet plan check " + quoted(folder_ / "out/plan_two.json") + " --skull " +
                       quoted(folder_ / "bar.stl") + " -o " + here);
  EXPECT_EQ(again.exit_code, 1);
  EXPECT_NE(again.error.find("landmarks_after.csv is an input of this check"), std::string::npos)
      << again.error;
  EXPECT_EQ(bytes("remainder.vtp"), skull);
  EXPECT_EQ(bytes("landmarks_after.csv"), landmarks);
  EXPECT_TRUE(fs::exists(folder_ / "out/check.json"));
  EXPECT_TRUE(fs::exists(folder_ / "out/plan_two.json"));
}

TEST_F(PlanCommand, AResultNamesItsInputs) {
  ASSERT_TRUE(io::write_landmarks(folder_ / "points.csv", plan::Landmarks{{"A", {0, -20, 5}}}));
  json named = plan();
  named["landmarks"] = "points.csv";
  ASSERT_EQ(check(named, "--no-pictures --gap 7").exit_code, 0);
  const json first = result();
  EXPECT_NE(first["notice"].get<std::string>().find("linical"), std::string::npos);
  EXPECT_FALSE(first["version"].get<std::string>().empty());
  EXPECT_EQ(first["limits"]["gap_mm"], 7.0);
  EXPECT_EQ(first["inputs"]["plan_files"][0]["file"], "points.csv");
  EXPECT_EQ(first["inputs"]["skull_sha256"].get<std::string>().size(), 64U);
  ASSERT_TRUE(io::write_landmarks(folder_ / "points.csv", plan::Landmarks{{"A", {0, -20, 6}}}));
  ASSERT_EQ(check(named, "--no-pictures --gap 7").exit_code, 0);
  const json second = result();
  EXPECT_EQ(first["inputs"]["plan_sha256"], second["inputs"]["plan_sha256"]);
  EXPECT_NE(first["inputs"]["plan_files"], second["inputs"]["plan_files"]);
}

/// A run without pictures takes those of the last one away: they would be of another plan.
TEST_F(PlanCommand, PicturesOfAnEarlierCheckAreRemoved) {
  ASSERT_EQ(check(plan()).exit_code, 0);
  ASSERT_TRUE(fs::exists(folder_ / "out/pictures/plan_cut_front.png"));
  ASSERT_EQ(check(plan(), "--no-pictures").exit_code, 0);
  EXPECT_FALSE(fs::exists(folder_ / "out/pictures/plan_cut_front.png"));
}

TEST_F(PlanCommand, BoneOverlapIsFound) {
  json backwards = plan();
  backwards["segments"][0]["path"]["keyframes"][0]["translation_mm"] = {0, 2, 0};
  const auto run = check(backwards, "--no-pictures");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.out.find("front and remainder overlap: at 100.0 %"), std::string::npos) << run.out;
  const json found = result();
  EXPECT_TRUE(found["has_findings"]);
  EXPECT_EQ(found["findings"][0]["kind"], "overlap");
  EXPECT_NEAR(found["overlaps"][0]["max_depth_mm"].get<double>(), 2.0, 0.2);
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
  EXPECT_NEAR(found["segments"][0]["max_gap_mm"].get<double>(), 12.0, 1e-3);
  forwards["segments"][0]["path"] = {
      {"distraction", {{{"towards", {0, -1, 0}}, {"mm_per_day", 1}, {"days", 12}}}}};
  const auto distracted = check(forwards, "--no-pictures");
  EXPECT_EQ(distracted.exit_code, 0) << distracted.out << distracted.error;
  EXPECT_NEAR(result()["segments"][0]["max_gap_mm"].get<double>(), 12.0, 1e-3);
}

TEST_F(PlanCommand, SegmentsAreCheckedAgainstEachOther) {
  json two = plan();
  two["segments"][0]["osteotomy"] = {
      {"planes", {{{"point_mm", {0, -5, 0}}, {"towards_segment", {0, -1, 0}}}}}};
  two["segments"][0]["path"]["keyframes"][0]["translation_mm"] = {0, 0, 0.5};
  two["segments"].push_back(two["segments"][0]);
  two["segments"][1]["name"] = "front-left";
  two["segments"][1]["cut_from"] = "front";
  two["segments"][1]["osteotomy"]["planes"][0] = {{"point_mm", {0, 0, 0}},
                                                  {"towards_segment", {1, 0, 0}}};
  two["segments"][1]["path"]["keyframes"][0]["translation_mm"] = {-3, 0, 0.5};
  const auto run = check(two, "--no-pictures");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.out.find("front and front-left overlap"), std::string::npos) << run.out;
  EXPECT_NEAR(result()["segments"][0]["volume_ml"].get<double>(), 3.0, 1e-6);
}

TEST_F(PlanCommand, AFailureIsOneLineAndLeavesNoOlderResults) {
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
}  // namespace lefort::app::test_plan_command
