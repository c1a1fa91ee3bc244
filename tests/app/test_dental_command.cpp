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

  const auto made = run_lefort("dental splint " + arches_of(folder.path()) +
                               " --voxel 0.3 --json --quiet -o '" + splint.string() + "'");
  ASSERT_EQ(made.exit_code, 0) << made.error;
  const auto json = nlohmann::json::parse(made.out);
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
