/// \file
/// `lefort plan optimize` on the small made-up head.
#include <lefort/io/read_text.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/volume_files.h>
#include <lefort/io/write_atomically.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "support/result_file.h"
#include "support/run_program.h"
#include "support/shapes.h"
#include "support/small_head.h"
#include "support/temporary_folder.h"

namespace lefort::app::test_optimize_command {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::string quoted(const fs::path& path) { return "'" + path.string() + "'"; }

class OptimizeCommand : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(io::write_volume(folder_ / "ct.nrrd", test::small_head()));
    write("plan.json", plan_with({0.0, -3.0, 0.0}));
  }
  void write(const std::string& file, const json& content) {
    ASSERT_TRUE(io::write_text(folder_ / file, content.dump()));
  }
  static json plan_with(const std::vector<double>& translation_mm) {
    json plan = test::small_plan();
    plan["segments"][0]["path"]["keyframes"][0]["translation_mm"] = translation_mm;
    return plan;
  }
  test::ProgramRun optimize(const std::string& more = "", const std::string& plan = "plan.json",
                            const std::string& out = "out") {
    return test::run_lefort("plan optimize " + quoted(folder_ / plan) + " --target " +
                            quoted(folder_ / "target.json") + " -o " + quoted(folder_ / out) +
                            " --quiet --no-pictures " + more);
  }
  json result(const std::string& out = "out") {
    return test::read_result(folder_ / out / "optimize.json", "optimize");
  }
  /// stderr of a run that must fail with one line.
  std::string error_of(const json& target) {
    write("target.json", target);
    const auto run = optimize();
    EXPECT_EQ(run.exit_code, 1);
    EXPECT_EQ(run.message_lines(), 1) << run.error;
    EXPECT_FALSE(fs::exists(folder_ / "out" / "optimize.json"));
    return run.error;
  }

  test::TemporaryFolder folder_;
};

json landmark(const std::string& name, const std::vector<double>& at_mm,
              const std::vector<double>& by_mm) {
  return {{"name", name}, {"at_mm", at_mm}, {"by_mm", by_mm}};
}

TEST_F(OptimizeCommand, RecoversTheMovementFromThePredictedFace) {
  const auto predicted =
      test::run_lefort("predict " + quoted(folder_ / "plan.json") + " -o " +
                       quoted(folder_ / "truth") + " --quiet --no-pictures --no-sensitivity");
  ASSERT_EQ(predicted.exit_code, 0) << predicted.error;
  // The head is a ball: rotations do not change it.
  write("target.json",
        {{"lefort_target", 1},
         {"surfaces", {{{"name", "face"}, {"file", "truth/predicted_skin.stl"}}}},
         {"bodies", {{{"segments", {"front"}}, {"free", {"left", "anterior", "superior"}}}}}});
  write("start.json", plan_with({1.0, -1.0, -1.5}));
  const auto run = optimize("", "start.json");
  ASSERT_EQ(run.exit_code, 0) << run.error;
  const json found = result();
  EXPECT_TRUE(found["converged"]);
  EXPECT_LE(found["gradient_check"]["relative_difference"], 1e-4);
  EXPECT_LT(found["objective_mm2"]["certified"], 1e-4);
  EXPECT_GT(found["objective_mm2"]["before_surgery"], 0.1);
  EXPECT_TRUE(found["targets"][0]["reached"]);
  const json plan = json::parse(io::read_text(folder_ / "out" / "plan.json", 1 << 20).value());
  const json& shift = plan["segments"][0]["path"]["keyframes"][0]["translation_mm"];
  const std::vector<double> truth{0.0, -3.0, 0.0};
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(double(shift[i]), truth[i], 0.1) << shift;
  EXPECT_EQ(plan["segments"][0]["path"]["steps"], 2);

  // The plan is one that the normal command runs, with the face that was certified.
  const auto again =
      test::run_lefort("predict " + quoted(folder_ / "out" / "plan.json") + " -o " +
                       quoted(folder_ / "again") + " --quiet --no-pictures --no-sensitivity");
  ASSERT_EQ(again.exit_code, 0) << again.error;
  EXPECT_EQ(io::read_text(folder_ / "again" / "predicted_skin.vtp", 1 << 28).value(),
            io::read_text(folder_ / "out" / "prediction" / "predicted_skin.vtp", 1 << 28).value());

  // Same bits with one thread, from the cache of the first run.
  const auto single = optimize("--threads 1", "start.json");
  ASSERT_EQ(single.exit_code, 0) << single.error;
  json one_thread = result(), first = found;
  one_thread.erase("seconds");
  first.erase("seconds");
  EXPECT_EQ(one_thread.dump(), first.dump());
}

TEST_F(OptimizeCommand, ReportsWhichLimitATargetPushesAgainst) {
  write("target.json",
        {{"lefort_target", 1},
         {"title", "Chin of a ball"},
         {"landmarks",
          {landmark("tip", {0, -47, 0}, {0, -6, 0}), landmark("side", {15, -44.5, 0}, {0, -5, 0})}},
         {"profiles", {{{"x_mm", 0}, {"points", {{{"z_mm", 5}, {"anterior_by_mm", 5}}}}}}},
         {"bodies",
          {{{"segments", {"front"}},
            {"free", {"anterior", "roll"}},
            {"bounds", {{"anterior_mm", {0, 2}}}}}}}});
  const auto run = optimize("--corrections 0 --no-gradient-check");
  ASSERT_EQ(run.exit_code, 0) << run.error;
  const json found = result();
  EXPECT_EQ(found["variables"][0]["at_bound"], "upper");
  EXPECT_EQ(found["variables"][0]["value"], 2.0);
  for (const json& target : found["targets"]) {
    EXPECT_FALSE(target["reached"]);
    EXPECT_EQ(target["reason"], "front anterior is at its upper bound, 2 mm");
  }
  EXPECT_EQ(found["gradient_check"], nullptr);
  EXPECT_EQ(found["title"], "Chin of a ball");
  // Of the targets a roll about the line of sight moves only the one at the side.
  EXPECT_LT(found["directions"].back()["face_mm_per_unit"].get<double>(),
            0.5 * found["directions"].front()["face_mm_per_unit"].get<double>())
      << found["directions"].dump();
  EXPECT_NE(found["directions"].back()["description"].get<std::string>().find("roll"),
            std::string::npos);
  const std::string report = io::read_text(folder_ / "out" / "report.html", 1 << 26).value();
  EXPECT_NE(report.find("front anterior is at its upper bound, 2 mm"), std::string::npos);
  EXPECT_NE(report.find("ot for clinical use"), std::string::npos);
}

TEST_F(OptimizeCommand, BadTargetsAreErrorsOfOneLine) {
  const auto says = [&](const json& target, const std::string& words) {
    const std::string error = error_of(target);
    EXPECT_NE(error.find(words), std::string::npos) << error;
  };
  const json good = landmark("tip", {0, -47, 0}, {0, -4, 0});
  says({{"lefort_target", 1}}, "the target is empty: it needs landmarks, profiles or surfaces");
  says({{"lefort_target", 1}, {"landmarks", {{{"name", "Sn"}, {"by_mm", {0, -4, 0}}}}}},
       "landmark Sn is not in the plan");
  says({{"lefort_target", 1}, {"landmarks", {landmark("tip", {0, -47, 0}, {0, -1000, 0})}}},
       "landmark tip would move by 1000 mm; at most 50 mm are possible");
  says({{"lefort_target", 1},
        {"landmarks", {good}},
        {"bodies", {{{"segments", {"front"}}, {"free", json::array()}}}}},
       "no number of any movement is free: nothing can be optimized");
  says({{"lefort_target", 1},
        {"landmarks", {good}},
        {"bodies", {{{"segments", {"front"}}, {"bounds", {{"anterior_mm", {3, 1}}}}}}}},
       "the bounds of anterior contradict each other, 3 > 1");
  says({{"lefort_target", 1}, {"landmarks", {good}}, {"bodies", {{{"segments", {"nose"}}}}}},
       "the plan has no segment nose");
  says({{"lefort_target", 1}, {"landmarks", {good}}, {"tint", 1}}, "tint");
  says({{"lefort_target", 1}, {"surfaces", {{{"file", "missing.stl"}}}}}, "missing.stl");

  geometry::TriangleMesh other = test::make_icosphere(47.0, 3);
  for (Vec3& v : other.vertices) v += Vec3(400, 0, 0);
  ASSERT_TRUE(io::write_surface(folder_ / "other.stl", other));
  says({{"lefort_target", 1}, {"surfaces", {{{"file", "other.stl"}}}}},
       "is it of another patient or in another frame?");

  for (const char* text : {"", "{", "[]", R"({"lefort_target": 1, "landmarks": [{"name": "a",
       "at_mm": [0, NaN, 0], "by_mm": [0, 1, 0]}]})"}) {
    ASSERT_TRUE(io::write_text(folder_ / "target.json", text));
    const auto run = optimize();
    EXPECT_EQ(run.exit_code, 1) << text;
    EXPECT_EQ(run.message_lines(), 1) << run.error;
  }
  fs::remove(folder_ / "target.json");
  EXPECT_EQ(optimize().exit_code, 1);
  EXPECT_EQ(test::run_lefort("plan optimize").exit_code, 2);
}

}  // namespace
}  // namespace lefort::app::test_optimize_command
