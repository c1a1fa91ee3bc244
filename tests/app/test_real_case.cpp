/// \file
/// The demo's plans on the real CT of Debian's invesalius-examples, coarse: scan in, face out.
#include <lefort/io/read_text.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/write_atomically.h>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>

#include "support/real_scan.h"
#include "support/result_file.h"
#include "support/run_program.h"
#include "support/temporary_folder.h"

namespace lefort::app::test_real_case {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::run_lefort;

constexpr double kForward_mm = 6.0;
constexpr double kElement_mm = 5.0;
constexpr double kMidPlane_mm = 122.0;  // x of the nose in this scan.

json demo_plan() {
  json plan = json::parse(
      io::read_text(fs::path(LEFORT_EXAMPLES) / "midface_forward.json", 1 << 20).value());
  plan["tissue"]["element_size_mm"] = kElement_mm;
  plan["tissue"]["far_element_size_mm"] = 9.0;
  plan["field"]["resolution"] = 128;
  return plan;
}

/// One folder for all tests here, so that costly stages are shared through its cache.
class RealCase : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<test::TemporaryFolder>();
    scan_ = test::real_scan();
  }
  static void TearDownTestSuite() { folder_.reset(); }
  void SetUp() override {
    ASSERT_TRUE(fs::exists(scan_)) << "Debian's invesalius-examples is neither installed nor to "
                                      "be had from apt";
  }

  static test::ProgramRun predict(const json& plan, const std::string& more = "",
                                  const std::string& setup = "") {
    EXPECT_TRUE(io::write_text(*folder_ / "plan.json", plan.dump()));
    return run_lefort("predict '" + (*folder_ / "plan.json").string() + "' --ct '" +
                          scan_.string() + "' -o '" + out().string() + "' --no-pictures " + more,
                      setup);
  }
  static fs::path out() { return *folder_ / "out"; }
  static json prediction() { return test::read_result(out() / "prediction.json", "prediction"); }
  static std::unique_ptr<test::TemporaryFolder> folder_;
  static fs::path scan_;
};
std::unique_ptr<test::TemporaryFolder> RealCase::folder_;
fs::path RealCase::scan_;

TEST_F(RealCase, MidfaceForwardGivesAFaceThatFollowsTheBone) {
  const auto run = predict(demo_plan());
  ASSERT_EQ(run.exit_code, 0) << run.error;
  const json result = prediction();
  ASSERT_TRUE(result["converged"]);
  EXPECT_EQ(result["mesh"]["inverted_elements"], 0);
  EXPECT_EQ(result["steps"].size(), 12U);
  for (const json& step : result["steps"]) {
    EXPECT_LE(step["relative_residual"], 1e-6);
    EXPECT_GT(step["min_volume_ratio"], 0.0);
    const json& contact = step["contact"];
    EXPECT_GT(contact["nodes"], 100);
    // Penalty contact leaves some penetration, and the mesh does not resolve fine details of bone.
    const double pushed_mm = step["path_fraction"].get<double>() * kForward_mm;
    EXPECT_LT(contact["mean_penetration_increase_mm"], 0.05 * pushed_mm + 0.01 * kElement_mm);
    EXPECT_LT(contact["max_penetration_increase_mm"], 0.3 * pushed_mm + 0.05 * kElement_mm);
  }

  const auto before = io::read_surface(out() / "skin_before.vtp").value();
  const auto after = io::read_surface(out() / "predicted_skin.vtp").value();
  ASSERT_EQ(before.vertex_count(), after.vertex_count());
  struct Side {
    double forward_mm = 0.0;
    int vertices = 0;
  } right, left;
  double max_forward_mm = 0.0;
  for (std::size_t v = 0; v < before.vertices.size(); ++v) {
    const Vec3& p = before.vertices[v];
    const Vec3 u = after.vertices[v] - p;
    max_forward_mm = std::max(max_forward_mm, -u.y());
    if (p.z() > 110.0) {
      EXPECT_LT(u.norm(), 0.05) << "forehead at " << p.transpose();
    }
    // Cheeks over the moved maxilla and zygoma.
    if (p.y() > 75.0 || p.z() < 20.0 || p.z() > 55.0 || std::abs(p.x() - kMidPlane_mm) < 15.0 ||
        std::abs(p.x() - kMidPlane_mm) > 45.0)
      continue;
    Side& side = p.x() < kMidPlane_mm ? right : left;
    side.forward_mm -= u.y();
    ++side.vertices;
  }
  ASSERT_GT(right.vertices, 500);
  ASSERT_GT(left.vertices, 500);
  right.forward_mm /= right.vertices;
  left.forward_mm /= left.vertices;
  EXPECT_GT(max_forward_mm, 0.5 * kForward_mm);
  EXPECT_LT(max_forward_mm, kForward_mm + 0.5);
  EXPECT_GT(right.forward_mm, 0.25 * kForward_mm);
  EXPECT_LT(right.forward_mm, kForward_mm);
  EXPECT_NEAR(right.forward_mm, left.forward_mm, 0.25 * right.forward_mm);
}

TEST_F(RealCase, SkinOfItsOwnIsWedgesOverTetrahedra) {
  json plan = demo_plan();
  plan["tissue"]["skin"] = {{"thickness_mm", 1.5}, {"layers", 1}};
  const auto run = predict(plan);
  ASSERT_EQ(run.exit_code, 0) << run.error;
  const json result = prediction();
  ASSERT_TRUE(result["converged"]);
  const json& mesh = result["mesh"];
  EXPECT_EQ(mesh["inverted_elements"], 0);
  EXPECT_GE(mesh["min_scaled_jacobian"], 0.05);
  EXPECT_GT(mesh["by_shape"]["wedge6"]["elements"], 500);
  EXPECT_GT(mesh["by_shape"]["tet4"]["elements"], 5000);
  EXPECT_GT(mesh["skin"]["covered_fraction"], 0.8);
  EXPECT_NEAR(mesh["skin"]["mean_thickness_mm"].get<double>(), 1.5, 0.2);
  EXPECT_EQ(result["parameters"]["skin"]["layers"], 1);

  // The mixed mesh goes through the cache, and the steps through the restart file, unchanged.
  json first = result;
  ASSERT_EQ(predict(plan).exit_code, 0);
  json second = prediction();
  first.erase("timing");
  second.erase("timing");
  EXPECT_EQ(first.dump(), second.dump());
}

TEST_F(RealCase, ReadingFromTheCacheGivesTheSameBytes) {  // Without: test_predict_command.cpp.
  std::error_code ignored;
  fs::remove_all(out(), ignored);
  ASSERT_EQ(predict(demo_plan()).exit_code, 0);
  json first = prediction();
  const std::string skin = io::read_text(out() / "predicted_skin.stl", 1 << 30).value();
  ASSERT_EQ(predict(demo_plan()).exit_code, 0);
  json second = prediction();
  first.erase("timing");
  second.erase("timing");
  EXPECT_EQ(first.dump(), second.dump());
  EXPECT_EQ(skin, io::read_text(out() / "predicted_skin.stl", 1 << 30).value());
}

TEST_F(RealCase, AnOsteotomyThatMissesTheBoneIsOneLine) {
  json plan = demo_plan();
  plan["segments"][0]["osteotomy"]["planes"][0] = {{"point_mm", {0, -500, 0}},
                                                   {"towards_segment", {0, -1, 0}}};
  const auto run = predict(plan);
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_EQ(run.message_lines(), 1) << run.error;
  EXPECT_NE(run.error.find("midface"), std::string::npos) << run.error;
}

TEST_F(RealCase, AStepBeyondTheBandIsOneLineThatSaysHowManyStepsItTakes) {
  json plan = demo_plan();
  plan["segments"][0]["path"]["steps"] = 1;
  const auto run = predict(plan);
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_EQ(run.message_lines(), 1) << run.error;
  EXPECT_NE(run.error.find("at least 2 steps"), std::string::npos) << run.error;
}

TEST_F(RealCase, AnInterruptEndsItCleanly) {
  std::error_code ignored;
  fs::remove_all(out(), ignored);
  // In the middle of its work, however long a busy machine takes to begin it.
  const std::string begun = fmt::format("[ -d '{}' ]", (out() / "cache").string());
  const auto run = predict(demo_plan(),
                           "& pid=\\$!; until " + begun +
                               " || ! kill -0 \\$pid; do sleep 0.1; done; sleep 3; "
                               "kill -INT \\$pid; wait \\$pid",
                           "");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_EQ(run.message_lines(), 1) << run.error;
  EXPECT_FALSE(fs::exists(out() / "prediction.json"));
  EXPECT_FALSE(fs::exists(out() / "report.html"));
  for (const auto& entry : fs::recursive_directory_iterator(out()))
    EXPECT_FALSE(entry.path().filename().string().starts_with(".partial")) << entry.path();
}

}  // namespace
}  // namespace lefort::app::test_real_case
