// Occlusion and splint of two arches, as a user types them, and files that are not what they should
// be.
#include <lefort/geometry/mesh_properties.h>
#include <lefort/geometry/transform_mesh.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/write_atomically.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <string>

#include "dental/arch.h"
#include "support/run_program.h"
#include "support/temporary_folder.h"

namespace lefort::app::test_dental_command {
namespace {

namespace fs = std::filesystem;
using test::run_lefort;

/// upper.stl and lower.stl, the lower one `open_mm` below its occlusion.
void write_arches(const fs::path& folder, double open_mm) {
  RigidTransform X = RigidTransform::Identity();
  X.translation() = Vec3(0.0, 0.0, -open_mm);
  ASSERT_TRUE(io::write_surface(folder / "upper.stl", test::make_arch({.seed = 3.0}, true)));
  ASSERT_TRUE(
      io::write_surface(folder / "lower.stl",
                        geometry::transformed(test::make_arch({.seed = 3.0, .step_mm = 0.4}), X)));
}

std::string arches_of(const fs::path& folder) {
  return "'" + (folder / "upper.stl").string() + "' '" + (folder / "lower.stl").string() + "'";
}

TEST(DentalCommand, finds_the_occlusion_and_makes_a_splint) {
  const test::TemporaryFolder folder;
  write_arches(folder.path(), 3.0);
  const fs::path occlusion = folder.path() / "occlusion", splint = folder.path() / "splint";
  const auto closed = run_lefort("dental occlusion " + arches_of(folder.path()) +
                                 " --json --quiet -o '" + occlusion.string() + "'");
  ASSERT_EQ(closed.exit_code, 0) << closed.error;
  const auto movement = nlohmann::json::parse(closed.out).at("movement");
  EXPECT_NEAR(movement.at("superior_mm").get<double>(), 3.0, 0.15);
  EXPECT_NEAR(movement.at("rotation_deg").get<double>(), 0.0, 0.3);
  EXPECT_TRUE(fs::exists(occlusion / "lower_to_occlusion.tfm"));
  EXPECT_TRUE(closed.out.find("requests") == std::string::npos ||
              nlohmann::json::parse(closed.out).at("requests").empty());

  const auto made =
      run_lefort("dental splint " + arches_of(folder.path()) +
                 " --voxel 0.3 --text 'A&B 1' --json --quiet -o '" + splint.string() + "'");
  ASSERT_EQ(made.exit_code, 0) << made.error;
  const auto json = nlohmann::json::parse(made.out);
  EXPECT_EQ(json.at("text"), "A&B 1");
  EXPECT_TRUE(fs::exists(splint / "splint.3mf"));
  for (const char* const text : {"longer than 16 letters", "   ", "two\nlines"})
    EXPECT_EQ(run_lefort("dental splint " + arches_of(folder.path()) + " --quiet --text '" + text +
                         "' -o '" + (folder.path() / "none").string() + "'")
                  .exit_code,
              1)
        << text;
  EXPECT_FALSE(fs::exists(folder.path() / "none"));
  EXPECT_GT(json.at("min_thickness_mm").get<double>(), 1.5);
  EXPECT_LT(json.at("upper").at("max_penetration_mm").get<double>(), 0.05);  // Voxels of 0.3 mm.
  const auto surface = io::read_surface(splint / "splint.stl");
  ASSERT_TRUE(surface) << surface.error().message;
  EXPECT_TRUE(geometry::is_closed(geometry::weld_vertices(*surface)));

  // The arch where it was, and its motion to occlusion: the splint has holes.
  const auto thin =
      run_lefort("dental splint " + arches_of(folder.path()) + " --lower-transform '" +
                 (occlusion / "lower_to_occlusion.tfm").string() + "' --voxel 0.3 --quiet -o '" +
                 splint.string() + "'");
  EXPECT_EQ(thin.exit_code, 0) << thin.error;
  EXPECT_NE(thin.out.find("warning: the splint has holes where teeth touch"), std::string::npos)
      << thin.out;
}

/// arches.json of scans whose files were in occlusion, moved by different motions.
void write_arches_json(const fs::path& file, double lower_shift_mm) {
  const auto arch = [](double shift_mm, double up) {
    return nlohmann::json{
        {"pose_4x4_row_major_mm_lps", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, shift_mm, 0, 0, 0, 1}},
        {"occlusal", {0, 0, up}},
        {"anterior", {0, -1, 0}}};
  };
  const nlohmann::json arches{
      {"lefort_arches", 1}, {"upper", arch(0.0, -1.0)}, {"lower", arch(lower_shift_mm, 1.0)}};
  ASSERT_TRUE(io::write_text(file, arches.dump()));
}

TEST(DentalCommand, takes_the_occlusion_of_the_scanner_and_cuts_the_upper_arch) {
  const test::TemporaryFolder folder;
  write_arches(folder.path(), 3.0);
  write_arches_json(folder.path() / "arches.json", -3.0);
  nlohmann::json teeth = nlohmann::json::array();
  for (const int fdi : {17, 16, 15, 14, 13, 12, 11, 21, 22, 23, 24, 25, 26, 27}) {
    const double t = (fdi < 20 ? -1.0 : 1.0) * (fdi % 10 - 0.5) / 7.0;
    teeth.push_back({{"fdi", fdi}, {"crown", {27.0 * t, 42.0 * t * t, 4.0}}});
    // Lower teeth opposite the upper ones, whose file is 3 mm below.
    teeth.push_back({{"fdi", fdi < 20 ? fdi + 30 : fdi + 10},
                     {"crown", {27.0 * t, 42.0 * t * t, 1.0}},
                     {"width_mm", 8.0}});
  }
  ASSERT_TRUE(io::write_text(folder.path() / "teeth.json",
                             nlohmann::json{{"lefort_teeth", 1}, {"teeth", teeth}}.dump()));
  const auto given = [&](const std::string& name) {
    return "'" + (folder.path() / name).string() + "' ";
  };
  const std::string command =
      "dental occlusion " + arches_of(folder.path()) + " --quiet --arches " + given("arches.json");
  const auto done = run_lefort(command + "--as-scanned --cut 11-21 --teeth " + given("teeth.json") +
                               "--json -o " + given("out"));
  ASSERT_EQ(done.exit_code, 0) << done.error;
  const auto json = nlohmann::json::parse(done.out);
  EXPECT_NEAR(json.at("movement").at("superior_mm").get<double>(), 3.0, 1e-9);
  EXPECT_EQ(json.at("source"), "as the files were scanned");
  EXPECT_NEAR(json.at("relations").at("midline_mm").get<double>(), 0.0, 1e-9);
  // The distal end of the lower canine is half a width behind the upper one, along the arch.
  EXPECT_NEAR(json.at("relations").at("right_canine").at("mesial_mm").get<double>(), -4.0, 1e-9);
  EXPECT_EQ(json.at("relations").at("left_canine").at("class"), "II");
  EXPECT_TRUE(json.at("relations").at("left_molar").at("class").is_null());  // Width unknown.
  ASSERT_EQ(json.at("pieces").size(), 2U);
  for (const auto& piece : json.at("pieces")) {  // The arch was in occlusion.
    EXPECT_NEAR(piece.at("movement").at("superior_mm").get<double>(), 0.0, 0.15);
    EXPECT_LT(piece.at("movement").at("rotation_deg").get<double>(), 1.0);
  }
  EXPECT_TRUE(fs::exists(folder.path() / "out/piece_2.tfm"));

  const auto refused = [&](const std::string& arguments, int exit_code, const std::string& why) {
    const auto result = run_lefort(arguments + " -o " + given("refused"));
    EXPECT_EQ(result.exit_code, exit_code) << arguments << "\n" << result.error;
    EXPECT_NE(result.error.find(why), std::string::npos) << result.error;
    EXPECT_FALSE(fs::exists(folder.path() / "refused"));
  };
  const std::string plain = "dental occlusion " + arches_of(folder.path()) + " --quiet ";
  refused(plain + "--as-scanned", 1, "--as-scanned needs --arches");
  refused(command + "--as-scanned --cut 11-21", 1, "--cut needs --teeth");
  refused(command + "--midline 1", 1, "--midline needs --teeth");
  refused(command + "--as-scanned --overjet 1", 1, "are for a search");
  refused(command + "--overjet 11", 2, "--overjet");
  refused(command + "--cut eleven", 2, "NUMBER-NUMBER");
  refused(command + "--as-scanned --cut 11-13 --teeth " + given("teeth.json"), 1,
          "are not two adjacent upper teeth");
  refused(command + "--bite " + given("upper.stl"), 1, "of the bite scan lies on the arches");
  ASSERT_TRUE(io::write_text(folder.path() / "arches.json",
                             "{\"lefort_arches\": 1, \"upper\": {\"occlusal\": [0, 0, -1], "
                             "\"anterior\": [0, -1, 0]}}"));
  refused(command + "--as-scanned", 1, "no motion of a scan");
}

TEST(DentalCommand, refuses_files_in_one_line) {
  const test::TemporaryFolder folder;
  write_arches(folder.path(), 3.0);
  const std::string arches = arches_of(folder.path());
  const fs::path bad = folder.path() / "bad.json", output = folder.path() / "output";
  const auto refused = [&](const std::string& arguments, int exit_code) {
    const auto result = run_lefort(arguments + " --quiet -o '" + output.string() + "'");
    EXPECT_EQ(result.exit_code, exit_code) << arguments << "\n" << result.error;
    EXPECT_EQ(std::count(result.error.begin(), result.error.end(), '\n'), 1) << result.error;
    EXPECT_FALSE(fs::exists(output)) << arguments;
  };
  for (const char* text :
       {"", "{", "[]", "{\"lefort_arches\": 1}", "{\"lefort_arches\": 2}",
        "{\"lefort_arches\": 1, \"upper\": {\"occlusal\": [0, 0, 1], \"anterior\": [0, 0, 1]}}",
        "{\"lefort_arches\": 1, \"upper\": {\"occlusal\": [0, 0, 2], \"anterior\": [0, 1, 0]}}",
        "{\"lefort_arches\": 1, \"upper\": {\"occlusal\": [0, null, 1], \"anterior\": [0, 1, "
        "0]}}"}) {
    ASSERT_TRUE(io::write_text(bad, text));
    refused("dental splint " + arches + " --arches '" + bad.string() + "'", 1);
    refused("dental occlusion " + arches + " --arches '" + bad.string() + "'", 1);
    refused("dental splint " + arches + " --lower-transform '" + bad.string() + "'", 1);
  }
  const std::string upper = "'" + (folder.path() / "upper.stl").string() + "'";
  refused("dental splint " + upper + " '" + bad.string() + "'", 1);
  refused("dental splint " + arches + " --clearance 3", 2);
  refused("dental splint " + arches + " --wall nan", 1);
}

}  // namespace
}  // namespace lefort::app::test_dental_command
