/// \file
/// `lefort predict` on a small made-up head: a ball of skin around a shell of bone, whose front
/// moves forward.
#include <lefort/io/read_text.h>
#include <lefort/io/segmentation_file.h>
#include <lefort/io/sha256.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/transform_file.h>
#include <lefort/io/volume_files.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/predict.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

#include "support/result_file.h"
#include "support/run_program.h"
#include "support/small_head.h"
#include "support/temporary_folder.h"

namespace lefort::app::test_predict_command {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::string quoted(const fs::path& path) { return "'" + path.string() + "'"; }

using test::small_head;
using test::small_plan;

/// A folder with scan and plan.
class PredictCommand : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(io::write_volume(folder_ / "ct.nrrd", small_head()));
    write_plan(small_plan());
  }
  void write_plan(const json& plan) {
    ASSERT_TRUE(io::write_text(folder_ / "plan.json", plan.dump()));
  }
  test::ProgramRun predict(const std::string& out, const std::string& more = "",
                           const std::string& before = "") {
    return test::run_lefort(before + "predict " + quoted(folder_ / "plan.json") + " -o " +
                            quoted(folder_ / out) + " " + more);
  }
  json read_json(const fs::path& file) {
    if (file.filename() == "prediction.json" || file.filename() == "failure.json")
      return test::read_result(folder_ / file, "prediction");
    const auto text = io::read_text(folder_ / file, 1 << 28);
    EXPECT_TRUE(text) << file;
    return text ? json::parse(*text) : json();
  }
  /// The contents of two result folders are equal, except run times.
  void expect_same_bytes(const fs::path& one, const fs::path& other,
                         std::initializer_list<const char*> files) {
    json first = read_json(one / "prediction.json"), second = read_json(other / "prediction.json");
    first.erase("timing");
    second.erase("timing");
    EXPECT_EQ(first.dump(), second.dump());
    for (const char* file : files)
      EXPECT_EQ(io::read_text(folder_ / one / file, 1 << 28).value(),
                io::read_text(folder_ / other / file, 1 << 28).value())
          << file;
  }
  [[nodiscard]] bool there_is(const fs::path& file) const { return fs::exists(folder_ / file); }

  test::TemporaryFolder folder_;
};

TEST_F(PredictCommand, WritesTheFaceAndAllThatDocumentsIt) {
  const auto run = predict("out");
  ASSERT_EQ(run.exit_code, 0) << run.error;
  for (const char* file :
       {"out/prediction.json", "out/report.html", "out/plan.json", "out/predicted_skin.stl",
        "out/skin_before.vtp", "out/paraview/prediction.pvd", "out/paraview/step_0002.vtu",
        "out/pictures/before_front.png", "out/pictures/after_front.png"})
    EXPECT_TRUE(there_is(file)) << file;
  const json result = read_json("out/prediction.json");
  EXPECT_TRUE(result["converged"]);
  EXPECT_GT(result["skin"]["max_shift_mm"], 1.0);
  EXPECT_LT(result["skin"]["max_shift_mm"], 3.5);
  EXPECT_EQ(result["inputs"]["labels_source"], "segmented");
  EXPECT_EQ(result["inputs"]["labels_sha256"].get<std::string>().size(), 64U);
  EXPECT_EQ(result["parameters"]["detection"], "smooth");
  EXPECT_EQ(result["parameters"]["stiffness_factor"], 10.0);
}

TEST_F(PredictCommand, ReportsTheInterfaceAndTheMotionOfTissueOnBone) {
  ASSERT_EQ(predict("out", "--no-pictures").exit_code, 0);
  const json result = read_json("out/prediction.json");
  const json& parameters = result["parameters"];
  EXPECT_EQ(parameters["interface"], "clinical");
  EXPECT_EQ(parameters["scan_boundary"], "roller");
  EXPECT_EQ(parameters["cut_boundary"], "roller");
  const json& interface = result["mesh"]["boundary"]["interface"];
  const std::size_t nodes = interface["nodes"].size();
  EXPECT_EQ(nodes, result["mesh"]["node_sets"]["boundary"].get<std::size_t>());
  const std::string conditions = interface["condition_of_nodes"],
                    rules = interface["rule_of_nodes"];
  EXPECT_EQ(conditions.size(), nodes);
  EXPECT_EQ(rules.size(), nodes);
  std::size_t in_groups = 0, elevated = 0, bonded = 0;
  for (const json& group : interface["groups"]) {
    in_groups += group["nodes"].get<std::size_t>();
    if (group["condition"] == "elevated") elevated += group["nodes"].get<std::size_t>();
    if (group["condition"] == "bonded") bonded += group["nodes"].get<std::size_t>();
    if (group["condition"] == "elevated") {
      EXPECT_EQ(group["rule"], "osteotomy");
      EXPECT_NE(group["segment"].is_null(), !group["on_stationary_bone"].get<bool>());
    }
  }
  EXPECT_EQ(in_groups, nodes);
  EXPECT_GT(elevated, 20U);
  EXPECT_GT(bonded, 20U);
  EXPECT_EQ(std::size_t(std::count(conditions.begin(), conditions.end(), 'e')), elevated);
  EXPECT_EQ(interface["letters"]["conditions"]["e"], "elevated");
  // Tissue slips where the bones separate by 3 mm, on either of them.
  const json& last = result["steps"].back();
  const json &on_segment = last["segments"][0]["supports"],
             &on_stationary = last["stationary_bone_supports"];
  EXPECT_EQ(on_segment["nodes"].get<std::size_t>() + on_stationary["nodes"].get<std::size_t>(),
            elevated);
  for (const json& supports : {on_segment, on_stationary}) {
    EXPECT_GT(supports["max_slip_mm"], 0.1);
    EXPECT_LT(supports["max_slip_mm"], 3.5);
    EXPECT_LT(supports["max_compression_mm"], 1.0);
  }
}

/// Without landmarks and template: the skin anterior to the segment, and no published range.
TEST_F(PredictCommand, ReportsTheRatioOfSkinToBone) {
  const auto run = predict("out", "--no-pictures");
  ASSERT_EQ(run.exit_code, 0) << run.error;
  const json ratios = read_json("out/prediction.json")["soft_tissue_ratios"];
  ASSERT_EQ(ratios.size(), 1U) << ratios;
  EXPECT_EQ(ratios[0]["segment"], "front");
  EXPECT_EQ(ratios[0]["procedure"], "unknown");
  EXPECT_EQ(ratios[0]["direction"], "advancement");
  EXPECT_EQ(ratios[0]["soft"], "facing skin");
  EXPECT_TRUE(ratios[0]["main_axis"]);
  EXPECT_NEAR(ratios[0]["hard_mm"], 3.0, 1e-9);
  EXPECT_GT(ratios[0]["ratio"], 0.1);
  EXPECT_LT(ratios[0]["ratio"], 1.1);
  EXPECT_TRUE(ratios[0]["published"].is_null());
  const std::string report = io::read_text(folder_ / "out/report.html", 1 << 26).value();
  EXPECT_NE(report.find("No published range is known for this movement."), std::string::npos);
}

TEST_F(PredictCommand, ComparesRatiosOfLandmarksWithPublishedRanges) {
  json plan = small_plan();
  plan["landmarks"] = {{"A", {0, -32, 0}}, {"Sn", {0, -47, 0}}};
  write_plan(plan);
  const auto run = predict("out", "--no-pictures");
  ASSERT_EQ(run.exit_code, 0) << run.error;
  const json ratios = read_json("out/prediction.json")["soft_tissue_ratios"];
  ASSERT_EQ(ratios.size(), 2U) << ratios;
  const json& lip = ratios[1];
  EXPECT_EQ(lip["procedure"], "le-fort-1") << "A lies on the segment";
  EXPECT_EQ(lip["soft"], "Sn");
  EXPECT_EQ(lip["hard"], "A");
  EXPECT_EQ(lip["published"]["sources"], json({"rosen1988"}));
  EXPECT_EQ(lip["published"]["low"], 0.38);
  EXPECT_EQ(lip["published"]["inside"], lip["ratio"] >= 0.38 && lip["ratio"] <= 0.64);
  const std::string report = io::read_text(folder_ / "out/report.html", 1 << 26).value();
  EXPECT_NE(report.find("Rosen 1988"), std::string::npos);
  EXPECT_NE(report.find("Lip-nasal aesthetics following Le Fort I osteotomy"), std::string::npos);
}

TEST_F(PredictCommand, TheCopiedPlanFindsItsScan) {
  ASSERT_EQ(predict("out", "--no-pictures").exit_code, 0);
  EXPECT_EQ(read_json("out/plan.json")["ct"], "../ct.nrrd");
  const auto again = test::run_lefort("predict " + quoted(folder_ / "out/plan.json") + " -o " +
                                      quoted(folder_ / "again") + " --no-pictures");
  EXPECT_EQ(again.exit_code, 0) << again.error;
}

/// A file that the plan names changes the plan, though not its text.
TEST_F(PredictCommand, TheFilesThatThePlanNamesAreFingerprinted) {
  RigidTransform forwards = RigidTransform::Identity();
  forwards.translation().y() = -3.0;
  ASSERT_TRUE(io::write_transform(folder_ / "move.tfm", forwards));
  json plan = small_plan();
  plan["segments"][0]["path"]["keyframes"] = {
      {{"transform", "move.tfm"}, {"about_mm", {0, -28, 0}}}};
  plan["segments"][0]["path"]["steps"] = 1;
  write_plan(plan);
  const auto run = predict("out", "--no-pictures");
  ASSERT_EQ(run.exit_code, 0) << run.error;
  const json files = read_json("out/prediction.json")["inputs"]["plan_files"];
  ASSERT_EQ(files.size(), 1U);
  EXPECT_EQ(files[0]["file"], "move.tfm");
  EXPECT_EQ(files[0]["sha256"], io::sha256_of_file(folder_ / "move.tfm").value());
  EXPECT_EQ(read_json("out/plan.json")["segments"][0]["path"]["keyframes"][0]["transform"],
            "../move.tfm");
}

TEST_F(PredictCommand, AFailedRerunLeavesNoOlderFace) {
  ASSERT_EQ(predict("out").exit_code, 0);
  json hopeless = small_plan();
  hopeless["solver"] = {{"max_iterations", 1}, {"min_increment_ratio", 1}};
  write_plan(hopeless);
  const auto failed = predict("out");
  EXPECT_EQ(failed.exit_code, 1);
  EXPECT_EQ(failed.message_lines(), 1) << failed.error;
  EXPECT_NE(failed.error.find("failure.json"), std::string::npos) << failed.error;
  for (const char* file :
       {"out/prediction.json", "out/predicted_skin.stl", "out/predicted_skin.vtp",
        "out/bone_segment_moved.vtp", "out/paraview/prediction.pvd", "out/paraview/step_0002.vtu",
        "out/pictures/after_front.png"})
    EXPECT_FALSE(there_is(file)) << file;
  const json failure = read_json("out/failure.json");
  EXPECT_FALSE(failure["converged"]);
  EXPECT_FALSE(failure["failed_attempts"].empty());
  const std::string report = io::read_text(folder_ / "out/report.html", 1 << 26).value();
  EXPECT_NE(report.find("no equilibrium"), std::string::npos);

  write_plan(small_plan());
  ASSERT_EQ(predict("out", "--no-pictures").exit_code, 0);
  EXPECT_TRUE(there_is("out/prediction.json"));
  EXPECT_FALSE(there_is("out/failure.json"));
}

TEST_F(PredictCommand, GivesTheSameBytesForAnyNumberOfThreadsWithoutACache) {
  ASSERT_EQ(predict("one", "--no-pictures", "--threads 1 ").exit_code, 0);
  ASSERT_EQ(predict("two", "--no-pictures", "--threads 2 ").exit_code, 0);
  json one = read_json("one/prediction.json"), two = read_json("two/prediction.json");
  one.erase("timing");
  two.erase("timing");
  EXPECT_EQ(one.dump(), two.dump());
  const auto skin = [&](const char* file) {
    return io::read_text(folder_ / file, 1 << 28).value();
  };
  EXPECT_EQ(skin("one/predicted_skin.stl"), skin("two/predicted_skin.stl"));
}

/// Asks to stop once a step has converged.
class StopAfterAStep final : public Progress {
 public:
  void note(std::string_view text) override {
    if (text.find("% of the path") != std::string_view::npos) stop_ = true;
  }
  [[nodiscard]] bool stop_requested() const override { return stop_; }

 private:
  bool stop_ = false;
};

TEST_F(PredictCommand, StoppedAndRunAgainItWritesTheBytesOfARunThatWasNot) {
  ASSERT_EQ(predict("whole", "--no-pictures").exit_code, 0);
  const pipeline::PredictJob job{folder_ / "plan.json", std::nullopt, folder_ / "stopped", false};
  StopAfterAStep stop;
  const auto stopped = pipeline::predict_case(job, stop);
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().code, ErrorCode::kCancelled);
  EXPECT_FALSE(there_is("stopped/prediction.json"));
  const auto rest = predict("stopped", "--no-pictures");
  ASSERT_EQ(rest.exit_code, 0) << rest.error;
  EXPECT_NE(rest.error.find("1 of 2 steps were computed by an earlier run"), std::string::npos)
      << rest.error;
  expect_same_bytes("whole", "stopped",
                    {"predicted_skin.vtp", "predicted_skin.stl", "paraview/step_0002.vtu"});
}

/// A ball at the front of the bone, which is the segment, painted with one label.
void paint(const fs::path& file, const std::string& label, double at_x_mm = 0.0,
           double at_y_mm = -30.0) {
  const image::Grid grid = small_head().grid;
  anatomy::LabelMap painted{grid, {}};
  for (Index k = 0; k < grid.size[2]; ++k)
    for (Index j = 0; j < grid.size[1]; ++j)
      for (Index i = 0; i < grid.size[0]; ++i) {
        const Vec3 p_L = grid.point_L(Vec3(double(i), double(j), double(k)));
        const bool is_near = (p_L - Vec3(at_x_mm, at_y_mm, 0.0)).norm() < 12.0;
        painted.values.push_back(is_near ? anatomy::Tissue::kBone : anatomy::Tissue::kBackground);
      }
  ASSERT_TRUE(io::write_segmentation(file, painted));
  std::string bytes = io::read_text(file, 1 << 20).value();
  const std::string name = "Segment0_Name:=bone", others = "Segment1_ID";
  bytes.replace(bytes.find(name), name.size(), "Segment0_Name:=" + label);
  bytes.replace(bytes.find(others), others.size(), "Another1_ID");  // The list ends before it.
  ASSERT_TRUE(io::write_text(file, bytes));
}

TEST_F(PredictCommand, APaintedBoundaryOverridesTheRuleAndIsReportedAndFingerprinted) {
  write_plan(test::with_paper_boundary(small_plan()));
  ASSERT_EQ(predict("by_rule", "--no-pictures").exit_code, 0);
  const json by_rule = read_json("by_rule/prediction.json");
  EXPECT_TRUE(by_rule["mesh"]["boundary"]["painted"].is_null());
  EXPECT_TRUE(by_rule["parameters"]["elevation_margin_mm"].is_null());
  Index nodes = 0;
  for (const json& rule : by_rule["mesh"]["boundary"]["rules"]) {
    nodes +=
        rule["fixed"].get<Index>() + rule["with_segment"].get<Index>() + rule["free"].get<Index>();
    EXPECT_EQ(rule["painted_over"], 0);
  }
  EXPECT_EQ(nodes, by_rule["mesh"]["node_sets"]["boundary"]);

  paint(folder_ / "painted.seg.nrrd", "fixed");
  json plan = test::with_paper_boundary(small_plan());
  plan["boundary"]["labels"] = "painted.seg.nrrd";
  write_plan(plan);
  const pipeline::PredictJob job{folder_ / "plan.json", std::nullopt, folder_ / "fixed", false};
  StopAfterAStep stop;
  EXPECT_EQ(pipeline::predict_case(job, stop).error().code, ErrorCode::kCancelled);
  paint(folder_ / "painted.seg.nrrd", "with segment");  // The cached steps are not valid now.
  const auto run = predict("fixed", "--no-pictures");
  ASSERT_EQ(run.exit_code, 0) << run.error;
  EXPECT_EQ(run.error.find("computed by an earlier run"), std::string::npos) << run.error;
  EXPECT_NE(run.error.find("painted: fixed 0, free 0, with segment "), std::string::npos)
      << run.error;
  const json painted = read_json("fixed/prediction.json");
  const json& reported = painted["mesh"]["boundary"]["painted"];
  EXPECT_EQ(reported["painted_fixed"], 0);
  EXPECT_GT(reported["painted_with_segment"], 0);
  EXPECT_NEAR(reported["within_mm"].get<double>(), 1.5 * std::sqrt(3.0), 1e-12);
  EXPECT_EQ(painted["inputs"]["plan_files"][0]["file"], "painted.seg.nrrd");
  EXPECT_EQ(painted["inputs"]["plan_files"][0]["sha256"],
            io::sha256_of_file(folder_ / "painted.seg.nrrd").value());
  EXPECT_EQ(read_json("fixed/plan.json")["boundary"]["labels"], "../painted.seg.nrrd");
  EXPECT_NE(painted["skin"]["mean_shift_where_moved_mm"],
            by_rule["skin"]["mean_shift_where_moved_mm"]);
}

TEST_F(PredictCommand, LabeledMuscleIsARegionOfItsOwnMaterial) {
  json plan = small_plan();
  write_plan(plan);
  ASSERT_EQ(predict("plain", "--no-pictures").exit_code, 0);
  EXPECT_EQ(read_json("plain/prediction.json")["mesh"]["regions"].size(), 1U);

  // A ball of soft tissue in front of the bone is muscle, as if painted in Slicer.
  ASSERT_EQ(test::run_lefort("segment " + quoted(folder_ / "ct.nrrd") + " -o " +
                             quoted(folder_ / "anatomy"))
                .exit_code,
            0);
  const fs::path file = folder_ / "anatomy/labels.seg.nrrd";
  anatomy::LabelMap labels = io::read_segmentation(file).value();
  const Vec3 center_L(0.0, -39.5, 0.0);
  for (Index k = 0; k < labels.grid.size[2]; ++k)
    for (Index j = 0; j < labels.grid.size[1]; ++j)
      for (Index i = 0; i < labels.grid.size[0]; ++i) {
        const Vec3 p_L = labels.grid.point_L(Vec3(double(i), double(j), double(k)));
        anatomy::Tissue& label = labels.at(i, j, k);
        if (label == anatomy::Tissue::kSoftTissue && (p_L - center_L).norm() < 12.0)
          label = anatomy::Tissue::kMuscle;
      }
  ASSERT_TRUE(io::write_segmentation(folder_ / "painted.seg.nrrd", labels));
  plan["segmentation"] = {{"labels", "painted.seg.nrrd"}};
  plan["tissue"]["muscle"] = {
      {"material", {{"law", "neo-hookean"}, {"young_kpa", 300}, {"poisson", 0.45}}}};
  write_plan(plan);
  const auto run = predict("muscle", "--no-pictures");
  ASSERT_EQ(run.exit_code, 0) << run.error;
  EXPECT_NE(run.error.find("; muscle "), std::string::npos) << run.error;
  const json reported = read_json("muscle/prediction.json");
  const json& regions = reported["mesh"]["regions"];
  EXPECT_GT(regions["muscle"]["elements"], 20);
  EXPECT_NEAR(
      regions["muscle"]["volume_ml"].get<double>() + regions["inside"]["volume_ml"].get<double>(),
      reported["mesh"]["volume_ml"].get<double>(), 1e-9);
  EXPECT_EQ(reported["parameters"]["muscle"]["young_kpa"], 300.0);
  EXPECT_GT(reported["tissue_volumes_ml"]["muscle"], 1.0);
  EXPECT_EQ(reported["mesh"]["nodes"], read_json("plain/prediction.json")["mesh"]["nodes"]);
  // It differs from what was predicted without, and is painted in vain far away.
  EXPECT_NE(reported["skin"], read_json("plain/prediction.json")["skin"]);

  for (anatomy::Tissue& label : labels.values)
    if (label == anatomy::Tissue::kMuscle) label = anatomy::Tissue::kSoftTissue;
  labels.at(18, 31, 18) = anatomy::Tissue::kMuscle;  // At the back of the head.
  ASSERT_TRUE(io::write_segmentation(folder_ / "painted.seg.nrrd", labels));
  const auto vain = predict("vain", "--no-pictures");
  ASSERT_EQ(vain.exit_code, 0) << vain.error;
  EXPECT_NE(vain.error.find("warning: tissue.muscle has no effect"), std::string::npos)
      << vain.error;
}

TEST_F(PredictCommand, TissuePaintedAsContactMeetsStationaryBone) {
  json plan = test::with_paper_boundary(small_plan());
  plan["boundary"]["labels"] = "painted.seg.nrrd";
  write_plan(plan);
  paint(folder_ / "painted.seg.nrrd", "contact", 28.0, -10.0);  // Beside the segment.
  const pipeline::PredictJob job{folder_ / "plan.json", std::nullopt, folder_ / "out", false};
  StopAfterAStep stop;
  ASSERT_EQ(pipeline::predict_case(job, stop).error().code, ErrorCode::kCancelled);
  const auto run = predict("out", "--no-pictures");
  ASSERT_EQ(run.exit_code, 0) << run.error;
  EXPECT_NE(run.error.find("computed by an earlier run"), std::string::npos) << run.error;
  const json reported = read_json("out/prediction.json");
  EXPECT_TRUE(reported["converged"].get<bool>());
  EXPECT_GT(reported["mesh"]["boundary"]["painted"]["painted_contact"], 5);
  for (const json& step : reported["steps"]) {
    EXPECT_GT(step["stationary_bone_contact"]["area_mm2"], 1.0);
    EXPECT_LT(step["stationary_bone_contact"]["max_penetration_increase_mm"], 1.0);
  }
}

/// Where tissue is bonded, paint that releases it changes no other set than its own.
TEST_F(PredictCommand, StepsWithOtherPaintAreNotResumed) {
  json plan = small_plan();
  plan["boundary"] = {{"interface", "bonded"}, {"labels", "painted.seg.nrrd"}};
  write_plan(plan);
  paint(folder_ / "painted.seg.nrrd", "free");
  const pipeline::PredictJob job{folder_ / "plan.json", std::nullopt, folder_ / "out", false};
  StopAfterAStep stop;
  ASSERT_EQ(pipeline::predict_case(job, stop).error().code, ErrorCode::kCancelled);
  paint(folder_ / "painted.seg.nrrd", "free", 6.0);
  const auto run = predict("out", "--no-pictures");
  ASSERT_EQ(run.exit_code, 0) << run.error;
  EXPECT_EQ(run.error.find("computed by an earlier run"), std::string::npos) << run.error;
}

TEST_F(PredictCommand, BoneOverlapAlongThePathIsReported) {
  json plan = small_plan();
  plan["segments"][0]["path"] = {{"steps", 2}, {"keyframes", {{{"translation_mm", {0, 3, 0}}}}}};
  write_plan(plan);
  const auto run = predict("out", "--no-pictures");
  ASSERT_EQ(run.exit_code, 0) << run.error;
  EXPECT_NE(run.error.find("bones overlap along the path: at 100.0 %"), std::string::npos)
      << run.error;
  const json overlaps = read_json("out/prediction.json")["bone_overlap"];
  ASSERT_EQ(overlaps.size(), 2U);
  EXPECT_GT(overlaps[1]["volume_ml"], overlaps[0]["volume_ml"]);
  EXPECT_NEAR(overlaps[1]["max_depth_mm"].get<double>(), 3.0, 0.8);
  EXPECT_TRUE(there_is("out/bone_overlap.vtp"));
  const std::string report = io::read_text(folder_ / "out/report.html", 1 << 26).value();
  EXPECT_NE(report.find("bones overlap along the path"), std::string::npos);

  write_plan(small_plan());  // Forward it touches nothing.
  ASSERT_EQ(predict("out", "--no-pictures").exit_code, 0);
  EXPECT_EQ(read_json("out/prediction.json")["bone_overlap"][1]["max_depth_mm"], 0.0);
  EXPECT_FALSE(there_is("out/bone_overlap.vtp"));
}

TEST_F(PredictCommand, ACachedStageIsTimedAsSuch) {
  ASSERT_EQ(predict("out", "--no-pictures").exit_code, 0);
  const auto again = predict("out", "--no-pictures");
  ASSERT_EQ(again.exit_code, 0) << again.error;
  const json stages = read_json("out/prediction.json")["timing"]["stage_seconds"];
  EXPECT_TRUE(stages.contains("read segment.field from the cache")) << stages.dump();
}

/// Mean of a surface's vertices.
Vec3 middle_of(const fs::path& surface) {
  const auto mesh = io::read_surface(surface);
  EXPECT_TRUE(mesh) << surface;
  Vec3 sum = Vec3::Zero();
  for (const Vec3& v : mesh->vertices) sum += v;
  return sum / double(mesh->vertices.size());
}

TEST_F(PredictCommand, SeveralSegmentsMoveTogetherAndEachIsReported) {
  ASSERT_EQ(predict("out", "--no-pictures").exit_code, 0);  // Of one: its files must go.
  json plan = test::with_paper_boundary(test::two_piece_plan({1, -4, 0}, {-1, -1, 0}));
  plan["segments"][1]["path"]["steps"] = 1;
  write_plan(plan);
  const auto run = predict("out");
  ASSERT_EQ(run.exit_code, 0) << run.error;
  const json result = read_json("out/prediction.json");
  EXPECT_TRUE(result["converged"]);
  EXPECT_EQ(result["parameters"]["steps"], 2);
  const json& segments = result["segments"];
  ASSERT_EQ(segments.size(), 2U);
  EXPECT_EQ(segments[0]["name"], "left");
  EXPECT_EQ(segments[1]["name"], "right");
  EXPECT_GT(segments[0]["volume_ml"], 1.0);
  EXPECT_NEAR(segments[0]["volume_ml"].get<double>(), segments[1]["volume_ml"].get<double>(), 0.5);
  EXPECT_GT(segments[1]["field"]["cell_mm"], 0.0);
  ASSERT_EQ(result["steps"].size(), 2U);
  const json& last = result["steps"][1];
  constexpr const char* kPose = "pose_4x4_row_major_mm_lps";
  EXPECT_EQ(last["segments"][0][kPose][7], -4.0);
  EXPECT_EQ(last["segments"][1][kPose][3], -1.0);
  EXPECT_EQ(result["steps"][0]["segments"][1][kPose][3], -0.5);
  const json &left = last["segments"][0]["contact"], &right = last["segments"][1]["contact"],
             &all = last["contact"];
  EXPECT_GT(left["normal_force_n"], right["normal_force_n"]);
  EXPECT_GT(right["nodes"], 0);
  EXPECT_EQ(all["nodes"], left["nodes"].get<int>() + right["nodes"].get<int>());
  EXPECT_EQ(all["max_penetration_increase_mm"], left["max_penetration_increase_mm"]);
  EXPECT_EQ(result["bone_overlap"].size(), 2U * 3U);  // Each with the other and with the remainder.

  for (const char* gone : {"out/bone_segment_moved.vtp", "out/bone_overlap.vtp"})
    EXPECT_FALSE(there_is(gone)) << gone;
  EXPECT_TRUE(there_is("out/pictures/bones_front.png"));
  const Vec3 left_L = middle_of(folder_ / "out/bone_segment_moved_left.vtp");
  const Vec3 right_L = middle_of(folder_ / "out/bone_segment_moved_right.vtp");
  EXPECT_GT(left_L.x(), 3.0);
  EXPECT_LT(right_L.x(), -3.0);
  EXPECT_NEAR(left_L.y() - right_L.y(), -3.0, 0.5);
  const std::string report = io::read_text(folder_ / "out/report.html", 1 << 26).value();
  EXPECT_NE(report.find("4.0 mm forward"), std::string::npos);
  EXPECT_NE(report.find("1.0 mm forward"), std::string::npos);
  EXPECT_NE(report.find("Segments at the end of the path"), std::string::npos);

  const auto before = io::read_surface(folder_ / "out/skin_before.vtp").value();
  const auto after = io::read_surface(folder_ / "out/predicted_skin.vtp").value();
  double left_mm = 0.0, right_mm = 0.0;  // The largest way forward of each half of the skin.
  for (std::size_t v = 0; v < before.vertices.size(); ++v) {
    double& max_mm = before.vertices[v].x() > 0.0 ? left_mm : right_mm;
    max_mm = std::max(max_mm, before.vertices[v].y() - after.vertices[v].y());
  }
  EXPECT_GT(left_mm, right_mm + 0.5);

  write_plan(small_plan());
  ASSERT_EQ(predict("out", "--no-pictures").exit_code, 0);
  EXPECT_FALSE(there_is("out/bone_segment_moved_left.vtp"));
  EXPECT_TRUE(there_is("out/bone_segment_moved.vtp"));
}

TEST_F(PredictCommand, ASegmentInTwoPiecesThatMoveTogetherEqualsOnePiece) {
  for (const char* obstacle : {"bone", "regularized"}) {
    // The interface of the paper: the cut between the pieces elevates no tissue.
    json plan = test::with_paper_boundary(small_plan());
    plan["contact"]["obstacle"] = obstacle;
    write_plan(plan);
    ASSERT_EQ(predict("one", "--no-pictures").exit_code, 0);
    plan = test::with_paper_boundary(test::two_piece_plan({0, -3, 0}, {0, -3, 0}));
    plan["contact"]["obstacle"] = obstacle;
    write_plan(plan);
    const auto run = predict("two", "--no-pictures");
    ASSERT_EQ(run.exit_code, 0) << run.error;
    const auto one = io::read_surface(folder_ / "one/predicted_skin.vtp").value();
    const auto two = io::read_surface(folder_ / "two/predicted_skin.vtp").value();
    ASSERT_EQ(one.vertices.size(), two.vertices.size());
    double max_mm = 0.0;
    for (std::size_t v = 0; v < one.vertices.size(); ++v)
      max_mm = std::max(max_mm, (one.vertices[v] - two.vertices[v]).norm());
    EXPECT_LT(max_mm, 0.1) << obstacle;  // Of the 3 mm.
  }
}

TEST_F(PredictCommand, SeveralSegmentsStoppedAndRunAgainGiveTheSameBytesOnAnyThreads) {
  write_plan(test::two_piece_plan({1, -3, 0}, {-1, -2, 0}));
  ASSERT_EQ(predict("whole", "--no-pictures", "--threads 2 ").exit_code, 0);
  const pipeline::PredictJob job{folder_ / "plan.json", std::nullopt, folder_ / "stopped", false};
  StopAfterAStep stop;
  ASSERT_EQ(pipeline::predict_case(job, stop).error().code, ErrorCode::kCancelled);
  const auto rest = predict("stopped", "--no-pictures", "--threads 1 ");
  ASSERT_EQ(rest.exit_code, 0) << rest.error;
  EXPECT_NE(rest.error.find("1 of 2 steps were computed by an earlier run"), std::string::npos)
      << rest.error;
  expect_same_bytes("whole", "stopped",
                    {"predicted_skin.stl", "bone_segment_moved_left.vtp",
                     "bone_segment_moved_right.vtp", "paraview/step_0002.vtu"});
  // Another path of one segment is another prediction.
  write_plan(test::two_piece_plan({1, -3, 0}, {-1, -2.5, 0}));
  const auto other = predict("stopped", "--no-pictures");
  ASSERT_EQ(other.exit_code, 0) << other.error;
  EXPECT_EQ(other.error.find("computed by an earlier run"), std::string::npos) << other.error;
}

TEST_F(PredictCommand, OverlapOfSegmentsIsReported) {
  write_plan(test::two_piece_plan({-2, -2, 0}, {0, -2, 0}));
  const auto run = predict("out", "--no-pictures");
  ASSERT_EQ(run.exit_code, 0) << run.error;
  EXPECT_NE(run.error.find("at 100.0 % segment left and segment right overlap"), std::string::npos)
      << run.error;
  double deepest_mm = 0.0;
  const json overlaps = read_json("out/prediction.json")["bone_overlap"];
  for (const json& pair : overlaps) {
    if (pair["first"] != "left" || pair["second"] != "right") continue;
    deepest_mm = std::max(deepest_mm, pair["max_depth_mm"].get<double>());
  }
  EXPECT_NEAR(deepest_mm, 2.0, 0.5) << overlaps;
  for (const char* file : {"out/bone_overlap_left.vtp", "out/bone_overlap_right.vtp"})
    EXPECT_TRUE(there_is(file)) << file;
}

TEST_F(PredictCommand, SeveralSegmentsThatCannotBeCutOrFollowedGetOneLineThatNamesThem) {
  const auto refused = [&](const json& plan, const std::string& says) {
    write_plan(plan);
    const auto run = predict("out", "--no-pictures");
    EXPECT_EQ(run.exit_code, 1);
    EXPECT_EQ(run.message_lines(), 1) << run.error;
    EXPECT_NE(run.error.find(says), std::string::npos) << run.error;
    EXPECT_FALSE(there_is("out/prediction.json"));
  };
  json twice = small_plan();
  twice["segments"].push_back(twice["segments"][0]);
  refused(twice, "two segments are called 'front'");
  twice["segments"][1]["name"] = "other";
  refused(twice, "osteotomy of 'other'");
  refused(test::two_piece_plan({0, -3, 0}, {0, -9, 0}), "segment right moves 4.50 mm in one step");
}

}  // namespace
}  // namespace lefort::app::test_predict_command
