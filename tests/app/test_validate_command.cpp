/// \file
/// `lefort validate`, `lefort calibrate` and `lefort phantom --cohort`, as a user runs them.
#include <lefort/io/read_text.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/volume_files.h>
#include <lefort/io/write_atomically.h>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>

#include <chrono>
#include <cmath>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "support/result_file.h"
#include "support/run_program.h"
#include "support/shapes.h"
#include "support/temporary_folder.h"

extern char** environ;

namespace lefort::app::test_validate_command {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::string quoted(const fs::path& path) { return "'" + path.string() + "'"; }

/// A cohort of three coarse synthetic cases, made once.
const fs::path& phantom_cohort() {
  static const test::TemporaryFolder folder;
  static const fs::path cohort = [] {
    const auto run = test::run_lefort("phantom --cohort 3 --voxel 4 --element-size 10 --quiet -o " +
                                      quoted(folder / "cohort"));
    EXPECT_EQ(run.exit_code, 0) << run.error;
    return folder / "cohort";
  }();
  return cohort;
}

/// Bytes of all files of a report.
std::map<std::string, std::string> bytes_of(const fs::path& report,
                                            const std::vector<std::string>& names) {
  std::map<std::string, std::string> files;
  for (const std::string& name : names)
    files[name] = io::read_text(report / name, 1 << 28).value_or("missing");
  if (fs::exists(report / "pictures"))
    for (const auto& entry : fs::directory_iterator(report / "pictures"))
      files[entry.path().filename().string()] = io::read_text(entry.path(), 1 << 28).value();
  return files;
}

/// Starts the program, kills it as soon as a file exists, and waits for its end.
void kill_when(const std::vector<std::string>& arguments, const fs::path& exists) {
  std::vector<std::string> texts{LEFORT_PROGRAM};
  texts.insert(texts.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  pid_t program = 0;
  ASSERT_EQ(::posix_spawn(&program, LEFORT_PROGRAM, nullptr, nullptr, pointers.data(), environ), 0);
  int status = 0;
  while (!fs::exists(exists) && ::waitpid(program, &status, WNOHANG) == 0)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  ASSERT_TRUE(fs::exists(exists));
  ::kill(program, SIGKILL);
  ::waitpid(program, &status, 0);
  EXPECT_TRUE(WIFSIGNALED(status)) << "the program ended before it was killed";
}

const std::vector<std::string> kValidation{"validation.json", "validation.csv", "report.html"};
const std::vector<std::string> kCalibration{"calibration.json", "calibration.csv",
                                            "calibration.html"};

const json& region_of(const json& result, const std::string& name) {
  for (const json& region : result["regions"])
    if (region["region"] == name) return region;
  throw std::out_of_range(name);
}

double mean_of(const json& region, const char* method) {
  return region["methods"][method]["mean_mm"]["mean"].get<double>();
}

TEST(ValidateCommand, PhantomCasesAreCloserThanNoChangeAndAKilledRunGivesTheSameBytes) {
  const test::TemporaryFolder folder;
  const std::string command = "validate " + quoted(phantom_cohort()) + " -o ";
  const auto run = test::run_lefort(command + quoted(folder / "whole"));
  ASSERT_EQ(run.exit_code, 0) << run.error;
  const json result = test::read_result(folder / "whole/validation.json", "validation");
  EXPECT_EQ(result["cases_compared"], 3) << result["failures"].dump();
  const json& face = region_of(result, "face");
  EXPECT_EQ(face["cases"], 3);
  EXPECT_LT(mean_of(face, "prediction"), 0.5);  // Noise of 0.3 mm, and parameters differ.
  EXPECT_GT(mean_of(face, "no_change"), mean_of(face, "prediction") + 0.3);
  EXPECT_GT(face["gain_mm"]["no_change"]["low"].get<double>(), 0.0);
  EXPECT_EQ(result["cases"][0]["regions_from"], "landmarks");
  EXPECT_TRUE(fs::exists(folder / "whole/pictures/case_01_difference_front.png"));

  kill_when({"validate", phantom_cohort().string(), "-o", (folder / "killed").string(), "--quiet"},
            folder / "killed/cases/case_01/result.json");
  EXPECT_FALSE(fs::exists(folder / "killed/validation.json"));
  const auto rest = test::run_lefort(command + quoted(folder / "killed"));
  ASSERT_EQ(rest.exit_code, 0) << rest.error;
  EXPECT_NE(rest.error.find("compared by an earlier run"), std::string::npos) << rest.error;
  EXPECT_EQ(bytes_of(folder / "whole", kValidation), bytes_of(folder / "killed", kValidation));
}

TEST(CalibrateCommand, ReducesTheErrorAndAKilledRunGivesTheSameBytes) {
  const test::TemporaryFolder folder;
  const std::string command = "calibrate " + quoted(phantom_cohort()) + " --max-iterations 4 -o ";
  const auto run = test::run_lefort(command + quoted(folder / "whole"));
  ASSERT_EQ(run.exit_code, 0) << run.error;
  const json result = test::read_result(folder / "whole/calibration.json", "calibration");
  ASSERT_EQ(result["folds"].size(), 3U);
  // Three cases on 10 mm elements do not determine the parameters: only the error is checked.
  EXPECT_LT(result["fit_error_mm"].get<double>(), result["start_error_mm"].get<double>());
  EXPECT_FALSE(result["held_out_error_mm"]["mean"].is_null());

  kill_when({"calibrate", phantom_cohort().string(), "--max-iterations", "4", "-o",
             (folder / "killed").string(), "--quiet"},
            folder / "killed/calibration/case_02/evaluations");
  const auto rest = test::run_lefort(command + quoted(folder / "killed"));
  ASSERT_EQ(rest.exit_code, 0) << rest.error;
  EXPECT_EQ(bytes_of(folder / "whole", kCalibration), bytes_of(folder / "killed", kCalibration));
}

/// A head of surfaces alone, whose mandible was moved as a whole; the movement is found.
TEST(ValidateCommand, SurfacesAloneAreEnoughAndTheMovementIsFound) {
  const test::TemporaryFolder folder;
  const fs::path one = folder / "cohort/head";
  fs::create_directories(one);
  geometry::TriangleMesh skin_L = test::make_icosphere(1.0, 5);
  for (Vec3& v : skin_L.vertices) {
    const double nose = 12.0 * std::exp(-30.0 * (v - Vec3(0, -1, 0.1)).squaredNorm());
    v = v.cwiseProduct(Vec3(52, 60, 75)) + Vec3(0, -nose, 0);
  }
  // Neither a sphere nor an ellipsoid: registration must not slide.
  geometry::TriangleMesh skull_L = test::make_icosphere(1.0, 5);
  for (Vec3& v : skull_L.vertices) {
    const double brow = 6.0 * std::exp(-8.0 * (v - Vec3(0.3, -0.9, 0.3)).squaredNorm());
    v = v.cwiseProduct(Vec3(28, 38, 32)) + Vec3(brow, 4 - brow, 28);
  }
  geometry::TriangleMesh mandible_L = test::make_icosphere(1.0, 4);
  for (Vec3& v : mandible_L.vertices) {
    v = v.cwiseProduct(Vec3(24, 14, 8)) + Vec3(0, -30, -40);
    v.y() += 0.02 * v.x() * v.x();  // An arch.
  }
  ASSERT_TRUE(io::write_surface(one / "before_skin.stl", skin_L));
  ASSERT_TRUE(io::write_surface(one / "before_skull.ply", skull_L));
  ASSERT_TRUE(io::write_surface(one / "before_mandible.obj", mandible_L));
  for (Vec3& v : mandible_L.vertices) v.y() += 3.0;
  ASSERT_TRUE(io::write_surface(one / "after_skin.vtp", skin_L));
  ASSERT_TRUE(io::write_surface(one / "after_skull.ply", skull_L));
  ASSERT_TRUE(io::write_surface(one / "after_mandible.ply", mandible_L));
  // This head has no orbits, by which landmarks are found.
  std::string landmarks = "name,x_mm,y_mm,z_mm\n";
  const auto add = [&](const std::string& name, double x, double z) {
    const double y = -60.0 * std::sqrt(1.0 - std::pow(x / 52.0, 2) - std::pow(z / 75.0, 2));
    landmarks += fmt::format("{},{},{},{}\n", name, x, y, z);
  };
  add("N'", 0, 38);
  add("Sn", 0, -1);
  add("Stm", 0, -18);
  add("Li", 0, -25);
  add("Pg'", 0, -40);
  add("Me'", 0, -53);
  for (const double side : {-1.0, 1.0}) {
    const std::string suffix = side < 0.0 ? "-R" : "-L";
    add("Al" + suffix, 13 * side, 2);
    add("En" + suffix, 13 * side, 33);
    add("Ex" + suffix, 35 * side, 33);
    add("Ch" + suffix, 20 * side, -18);
  }
  ASSERT_TRUE(io::write_text(one / "landmarks.csv", landmarks));
  ASSERT_TRUE(io::write_text(folder / "cohort/plan.json", R"({
    "lefort_plan": 1,
    "segments": [{"name": "jaw", "osteotomy": {"bone": "mandible"}}],
    "tissue": {"element_size_mm": 6, "far_element_size_mm": 10, "margin_mm": 45},
    "boundary": {"interface": "bonded"},
    "field": {"resolution": 64, "band_mm": 5}})"));
  const auto run = test::run_lefort("validate " + quoted(folder / "cohort") +
                                    " --voxel 2 --no-pictures -o " + quoted(folder / "out"));
  ASSERT_EQ(run.exit_code, 0) << run.error;
  const json result = test::read_result(folder / "out/validation.json", "validation");
  ASSERT_EQ(result["cases_compared"], 1) << result["failures"].dump();
  const json& head = result["cases"][0];
  EXPECT_EQ(head["movement"], "achieved");
  EXPECT_EQ(head["registered_on"], "bone");
  EXPECT_NEAR(head["segments"][0]["translation_mm"][1].get<double>(), 3.0, 0.2);
  EXPECT_LT(mean_of(region_of(result, "face"), "no_change"), 0.3);  // The skin did not move.
  EXPECT_TRUE(region_of(result, "face")["methods"]["prediction"]["mean_mm"]["low"].is_null());
}

TEST(ValidateCommand, CasesThatFailAreListedWithTheirReason) {
  const test::TemporaryFolder folder;
  const fs::path cohort = folder / "cohort";
  const auto add = [&](const std::string& name, const std::string& text) {
    fs::create_directories((cohort / name).parent_path());
    ASSERT_TRUE(io::write_text(cohort / name, text));
  };
  add("a_empty/notes.txt", "");
  add("b_damaged/before.nrrd", "no scan");
  add("b_damaged/after_skin.ply", "no skin");
  geometry::TriangleMesh open = test::make_icosphere(60.0, 3);
  open.triangles.pop_back();
  for (const char* file : {"before_skin.stl", "before_skull.stl", "after_skin.stl"}) {
    fs::create_directories(cohort / "c_open");
    ASSERT_TRUE(io::write_surface(cohort / "c_open" / file, open));
  }
  const auto run = test::run_lefort("validate " + quoted(cohort) + " -o " + quoted(folder / "out"));
  ASSERT_EQ(run.exit_code, 0) << run.error;
  const json result = test::read_result(folder / "out/validation.json", "validation");
  EXPECT_EQ(result["cases_failed"], 3);
  ASSERT_EQ(result["failures"].size(), 3U);
  EXPECT_NE(result["failures"][0]["reason"].get<std::string>().find("no head before surgery"),
            std::string::npos);
  EXPECT_NE(result["failures"][2]["reason"].get<std::string>().find("skin: the surface is open"),
            std::string::npos);
  for (const std::string& name : kValidation) {
    const std::string text = io::read_text(folder / "out" / name, 1 << 26).value();
    EXPECT_NE(text.find("b_damaged"), std::string::npos) << name;
    EXPECT_EQ(text.find(folder.path().string()), std::string::npos) << name << " names a folder";
  }
}

TEST(ValidateCommand, CohortsThatCannotBeReadGetOneLine) {
  const test::TemporaryFolder folder;
  fs::create_directories(folder / "empty");
  fs::create_directories(folder / "cohort/case");
  const auto refused = [&](const std::string& arguments, const std::string& says) {
    const auto run = test::run_lefort(arguments);
    EXPECT_EQ(run.exit_code, 1) << arguments;
    EXPECT_EQ(run.message_lines(), 1) << run.error;
    EXPECT_NE(run.error.find(says), std::string::npos) << run.error;
  };
  const std::string out = " -o " + quoted(folder / "out");
  for (const std::string command : {"validate ", "calibrate "}) {
    refused(command + quoted(folder / "missing") + out, "does not exist");
    refused(command + quoted(folder / "empty") + out, "has no case");
    refused(command + quoted(folder / "cohort") + " -o " + quoted(folder / "cohort/out"),
            "is inside the cohort");
  }
  refused("calibrate " + quoted(folder / "cohort") + out, "0 of 1 cases can be predicted");
  refused("calibrate " + quoted(folder / "cohort") + out + " --parameters color",
          "there is no parameter color");
  refused("phantom --cohort 2 -o " + quoted(folder / "cohort"), "is not empty");
}

}  // namespace
}  // namespace lefort::app::test_validate_command
