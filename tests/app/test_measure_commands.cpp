// Canals, airway and cephalogram of a synthetic head, as a user types them, and bad input.
#include <lefort/anatomy/parametric_head.h>
#include <lefort/geometry/mesh_properties.h>
#include <lefort/io/landmarks_file.h>
#include <lefort/io/segmentation_file.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/volume_files.h>
#include <lefort/io/vtu.h>
#include <lefort/io/write_atomically.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "support/run_program.h"
#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace lefort::app::test_measure_commands {
namespace {

namespace fs = std::filesystem;
using test::run_lefort;

/// A head with an airway of 8 mm radius, its labels and its landmarks, in a folder.
class MeasureCommands : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryFolder;
    const anatomy::ParametricHead head{{}};
    anatomy::LabeledScan scan = anatomy::scan_of(head, 1.5, 20.0, 3);
    const image::Grid& grid = scan.ct.grid;
    for (Index v = 0; v < grid.voxel_count(); ++v) {
      const Vec3 p_L =
          grid.point_L({double(v % grid.size[0]), double(v / grid.size[0] % grid.size[1]),
                        double(v / (grid.size[0] * grid.size[1]))});
      const Vec3 p = head.X_LH().inverse() * p_L;
      const double depth = kRadius_mm - std::hypot(p.x(), p.y() + 20.0);
      if (p.z() > -15.0 || depth < -1.0) continue;
      const double air = std::clamp(0.5 + depth / 1.5, 0.0, 1.0);
      scan.ct.values[std::size_t(v)] = std::int16_t(40.0 - 1040.0 * air);
      if (air > 0.5) scan.labels.values[std::size_t(v)] = anatomy::Tissue::kAirway;
    }
    for (auto& hu : scan.ct.values) hu = std::max<std::int16_t>(hu, -1024);
    plan::Landmarks landmarks;
    for (const anatomy::NamedPoint& one : anatomy::true_landmarks(head))
      landmarks.push_back({one.name, one.point_L});
    ASSERT_TRUE(io::write_volume(path("ct.nrrd"), scan.ct));
    ASSERT_TRUE(io::write_segmentation(path("labels.seg.nrrd"), scan.labels));
    ASSERT_TRUE(io::write_landmarks(path("landmarks.mrk.json"), landmarks));
  }
  static void TearDownTestSuite() { delete folder_; }

  static fs::path path(const std::string& name) { return folder_->path() / name; }
  static std::string inputs() {
    return "'" + path("ct.nrrd").string() + "' --labels '" + path("labels.seg.nrrd").string() +
           "' --landmarks '" + path("landmarks.mrk.json").string() + "' --quiet ";
  }
  static void expect_refused(const std::string& arguments, int exit_code,
                             const std::string& message) {
    const auto result = run_lefort(arguments + " -o '" + path("refused").string() + "'");
    EXPECT_EQ(result.exit_code, exit_code) << arguments << "\n" << result.error;
    EXPECT_EQ(std::count(result.error.begin(), result.error.end(), '\n'), 1) << result.error;
    EXPECT_NE(result.error.find(message), std::string::npos) << result.error;
    EXPECT_FALSE(fs::exists(path("refused")));
  }

  static constexpr double kRadius_mm = 8.0;
  static test::TemporaryFolder* folder_;
};
test::TemporaryFolder* MeasureCommands::folder_ = nullptr;

TEST_F(MeasureCommands, airway_of_known_radius) {
  const auto done =
      run_lefort("airway " + inputs() + "--json -o '" + path("airway").string() + "'");
  ASSERT_EQ(done.exit_code, 0) << done.error;
  const auto json = nlohmann::json::parse(done.out);
  const double area_mm2 = std::numbers::pi * kRadius_mm * kRadius_mm;
  EXPECT_NEAR(json.at("min_axial_section").at("area_mm2").get<double>(), area_mm2, 0.06 * area_mm2);
  const double length_mm = json.at("length_mm").get<double>();
  EXPECT_NEAR(json.at("volume_ml").get<double>(), area_mm2 * length_mm * 1e-3,
              0.08 * area_mm2 * length_mm * 1e-3);
  EXPECT_TRUE(io::read_surface(path("airway") / "airway.vtp"));
  std::ifstream table(path("airway") / "airway.csv");
  const auto lines = std::count(std::istreambuf_iterator<char>(table), {}, '\n');
  EXPECT_NEAR(double(lines), length_mm + 2.0, 2.0);
  EXPECT_TRUE(fs::exists(path("airway") / "airway.svg"));
}

/// The folder of a prediction in which all tissue moves away from the axis of the airway by a fifth
/// of its distance, and no bone moves.
void write_wider_prediction(const fs::path& folder) {
  const anatomy::ParametricHead head{{}};
  mesh::VolumeMesh tissue;
  std::vector<Vec3> shifts;
  for (double x = -40.0; x <= 40.0; x += 4.0)
    for (double y = -60.0; y <= 20.0; y += 4.0)
      for (double z = -140.0; z <= 0.0; z += 4.0) {
        tissue.nodes_L.emplace_back(head.X_LH() * Vec3(x, y, z));
        shifts.emplace_back(head.X_LH().linear() * Vec3(0.2 * x, 0.2 * (y + 20.0), 0.0));
      }
  const std::int32_t row = 36, plane = 21 * 36;
  tissue.blocks.push_back({mesh::ElementShape::kTet4, {0, plane, row, 1}, {0}});
  fs::create_directories(folder / "paraview");
  const std::vector<Vec3> none(shifts.size(), Vec3::Zero());
  for (const auto& [name, shift] : {std::pair{"step_0000.vtu", &none}, {"step_0001.vtu", &shifts}})
    ASSERT_TRUE(io::write_vtu(folder / "paraview" / name, tissue,
                              {.nodes = {io::vtu_array("displacement_mm", *shift)}}));
  const geometry::TriangleMesh bone = test::make_box({400, 400, 400}, {410, 410, 410});
  for (const char* const name : {"bone_segment_moved.vtp", "bone_remainder.vtp"})
    ASSERT_TRUE(io::write_surface(folder / name, bone));
  const nlohmann::json document{
      {"lefort_prediction", 2},
      {"converged", true},
      {"steps",
       {{{"segments",
          {{{"name", "chin"},
            {"pose_4x4_row_major_mm_lps", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}}}}}}}};
  ASSERT_TRUE(io::write_text(folder / "prediction.json", document.dump()));
}

TEST_F(MeasureCommands, airway_after_a_predicted_movement) {
  write_wider_prediction(path("wider"));
  const std::string command = "airway " + inputs() + "--prediction '";
  const auto done = run_lefort(command + path("wider").string() + "' --json -o '" +
                               path("airways").string() + "'");
  ASSERT_EQ(done.exit_code, 0) << done.error;
  const auto json = nlohmann::json::parse(done.out);
  const auto area_of = [](const nlohmann::json& one) {
    return one.at("min_axial_section").at("area_mm2").get<double>();
  };
  EXPECT_NEAR(area_of(json.at("after")) / area_of(json), 1.44, 0.06);
  EXPECT_GT(json.at("after").at("wall_in_tissue_mesh").get<double>(), 0.95);
  EXPECT_TRUE(io::read_surface(path("airways") / "airway_after.vtp"));

  ASSERT_TRUE(io::write_text(path("wider") / "prediction.json", "{\"steps\": [1]}"));
  expect_refused(command + path("wider").string() + "'", 1, "predict again");
  expect_refused(command + path("nowhere").string() + "'", 1, "prediction.json");
}

TEST_F(MeasureCommands, canals_pass_through_corrected_points) {
  const auto done = run_lefort("nerve " + inputs() + "--json -o '" + path("nerve").string() + "'");
  ASSERT_EQ(done.exit_code, 0) << done.error;
  EXPECT_GT(nlohmann::json::parse(done.out).at("left").at("length_mm").get<double>(), 30.0);
  EXPECT_TRUE(io::read_surface(path("nerve") / "nerve_left.vtp"));

  // The written points are landmarks of the next run, which finds the others itself.
  const auto points = io::read_landmarks(path("nerve") / "nerve.mrk.json");
  ASSERT_TRUE(points) << points.error().message;
  plan::Landmarks corrected;
  for (plan::Landmark point : *points) {
    if (point.name == "MeF-L") point.point_L.z() -= 3.0;
    if (point.name == "IAN-L-1") continue;  // Deleted by the user.
    if (point.name == "IAN-L-2") point.point_L.z() += 2.0;
    if (point.name.ends_with("-L") || point.name.starts_with("IAN-L")) corrected.push_back(point);
  }
  ASSERT_TRUE(io::write_landmarks(path("corrected.csv"), corrected));
  const auto again = run_lefort("nerve '" + path("ct.nrrd").string() + "' --labels '" +
                                path("labels.seg.nrrd").string() + "' --landmarks '" +
                                path("corrected.csv").string() + "' --quiet --json -o '" +
                                path("again").string() + "'");
  ASSERT_EQ(again.exit_code, 0) << again.error;
  const auto end = nlohmann::json::parse(again.out).at("left").at("mental_foramen");
  const Vec3 foramen_L(end[0].get<double>(), end[1].get<double>(), end[2].get<double>());
  EXPECT_LT((foramen_L - *plan::find_landmark(corrected, "MeF-L")).norm(), 2.0);
  double closest_mm = 100.0;
  const Vec3 given_L = *plan::find_landmark(corrected, "IAN-L-2");
  const nlohmann::json line = nlohmann::json::parse(again.out).at("left").at("points");
  for (const auto& p : line)
    closest_mm = std::min(
        closest_mm,
        (Vec3(p[0].get<double>(), p[1].get<double>(), p[2].get<double>()) - given_L).norm());
  EXPECT_LT(closest_mm, 1.5);

  // The corrections of the user are not overwritten.
  const std::string points_file = (path("nerve") / "nerve.mrk.json").string();
  const auto overwriting = run_lefort("nerve '" + path("ct.nrrd").string() + "' --labels '" +
                                      path("labels.seg.nrrd").string() + "' --quiet --landmarks '" +
                                      points_file + "' -o '" + path("nerve").string() + "'");
  EXPECT_EQ(overwriting.exit_code, 1);
  EXPECT_NE(overwriting.error.find("would be overwritten"), std::string::npos) << overwriting.error;
}

TEST_F(MeasureCommands, cephalogram_with_tracing_and_norms) {
  const auto done = run_lefort("cephalogram " + inputs() + "--norms male --json -o '" +
                               path("cephalogram").string() + "'");
  ASSERT_EQ(done.exit_code, 0) << done.error;
  const auto measurements = nlohmann::json::parse(done.out).at("measurements");
  EXPECT_TRUE(std::any_of(measurements.begin(), measurements.end(), [](const auto& one) {
    return one.at("measurement") == "A-Nperp" && one.at("before").is_number();
  }));
  for (const char* const name : {"lateral.png", "frontal.png", "tracing.png"})
    EXPECT_GT(fs::file_size(path("cephalogram") / name), 10000U) << name;
  const auto bytes_of = [](const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  const std::string pdf = bytes_of(path("cephalogram") / "cephalometry.pdf");
  EXPECT_TRUE(pdf.starts_with("%PDF-"));
  EXPECT_NE(bytes_of(path("cephalogram") / "norms.csv").find("McNamara,Co-A,mm,92.4 +- 5.6"),
            std::string::npos);
  const auto again =
      run_lefort("cephalogram " + inputs() + "--norms male -o '" + path("repeated").string() + "'");
  ASSERT_EQ(again.exit_code, 0) << again.error;
  EXPECT_EQ(bytes_of(path("repeated") / "cephalometry.pdf"), pdf);
}

/// A plan with a genioplasty, on the scan.
void write_chin_plan(const fs::path& file) {
  const nlohmann::json plan{{"lefort_plan", 1},
                            {"ct", "ct.nrrd"},
                            {"segmentation", {{"labels", "labels.seg.nrrd"}}},
                            {"landmarks", "landmarks.mrk.json"},
                            {"segments",
                             {{{"name", "chin"},
                               {"osteotomy", {{"template", "genioplasty"}, {"kerf_mm", 0.8}}},
                               {"path", {{"keyframes", {{{"translation_mm", {0, -6, 2}}}}}}}}}}};
  ASSERT_TRUE(io::write_text(file, plan.dump(1)));
}

TEST_F(MeasureCommands, cutting_guides_with_the_same_holes_before_and_after) {
  write_chin_plan(path("chin.json"));
  const std::string plan = "'" + path("chin.json").string() + "' --voxel 0.4 --quiet ";
  const fs::path output = path("guides");
  const auto done = run_lefort("plan guide " + plan + "--json -o '" + output.string() + "'");
  ASSERT_EQ(done.exit_code, 0) << done.error;
  const auto guides = nlohmann::json::parse(done.out).at("guides");
  ASSERT_EQ(guides.size(), 1U) << done.out;
  EXPECT_EQ(guides[0].at("name"), "chin_middle");
  EXPECT_EQ(guides[0].at("parts"), 1);
  EXPECT_NEAR(guides[0].at("slot_width_mm").get<double>(), 1.0, 1e-9);
  EXPECT_LT(guides[0].at("fit").at("max_penetration_mm").get<double>(), 0.05);
  EXPECT_NEAR(guides[0].at("fit").at("clearance_mm").at("median").get<double>(), 0.1, 0.03);
  const auto surface = io::read_surface(output / "guide_chin_middle.stl");
  ASSERT_TRUE(surface) << surface.error().message;
  EXPECT_TRUE(geometry::is_closed(geometry::weld_vertices(*surface)));
  int on_segment = 0, others = 0;
  for (const auto& hole : guides[0].at("holes")) {
    const bool moves = hole.at("bone") == "chin";
    ++(moves ? on_segment : others);
    const std::array<double, 3> shift{0.0, -6.0, 2.0};
    for (std::size_t axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(
          hole.at("after_mm")[axis].get<double>() - hole.at("before_mm")[axis].get<double>(),
          moves ? shift[axis] : 0.0, 1e-9);
  }
  EXPECT_GE(on_segment, 2);
  EXPECT_GE(others, 2);
  const auto before = io::read_landmarks(output / "holes_before.mrk.json");
  ASSERT_TRUE(before);
  EXPECT_EQ(before->size(), guides[0].at("holes").size());

  // Guides of an earlier run do not stay.
  const auto again = run_lefort("plan guide " + plan + "--from right -o '" + output.string() + "'");
  ASSERT_EQ(again.exit_code, 0) << again.error;
  EXPECT_FALSE(fs::exists(output / "guide_chin_middle.stl"));
  EXPECT_TRUE(fs::exists(output / "guide_chin_right.stl")) << again.out;

  expect_refused("plan guide " + plan + "--segment nose", 1, "the plan has no segment 'nose'");
  expect_refused("plan guide " + plan + "--from above", 2, "--from");
  expect_refused("plan guide " + plan + "--hole-distance 9", 1, "must be 11.25 mm or more");
}

TEST_F(MeasureCommands, plans_side_by_side) {
  write_chin_plan(path("chin.json"));
  std::ifstream in(path("chin.json"));
  nlohmann::json plan = nlohmann::json::parse(in);
  plan["segments"][0]["path"]["keyframes"][0]["translation_mm"] = {0, -3, 0};
  ASSERT_TRUE(io::write_text(path("less.json"), plan.dump()));
  for (const std::string name : {"chin", "less"}) {
    const auto checked =
        run_lefort("plan check '" + path(name + ".json").string() + "' --no-pictures --quiet -o '" +
                   (path("plans") / name / "check").string() + "'");
    ASSERT_LE(checked.exit_code, 1) << checked.error;  // 1: findings.
    ASSERT_TRUE(fs::exists(path("plans") / name / "check/check.json")) << checked.error;
  }
  const std::string first = "'" + (path("plans") / "chin").string() + "' ";
  const std::string second = "'" + (path("plans") / "less").string() + "/' ";
  const auto done = run_lefort("plan variants " + first + second + "--quiet -o '" +
                               path("variants").string() + "'");
  ASSERT_EQ(done.exit_code, 0) << done.error;
  std::ifstream table(path("variants") / "variants.csv");
  const std::string csv(std::istreambuf_iterator<char>(table), {});
  EXPECT_TRUE(csv.starts_with("\"segment, point\",\"chin\",\"less\"\n")) << csv;
  EXPECT_NE(csv.find("\"chin, Pg\",\"6.0 forward, 2.1 up\",\"3.0 forward\""), std::string::npos)
      << csv;
  for (const char* const name : {"variants.html", "variants.pdf", "variants.json"})
    EXPECT_GT(fs::file_size(path("variants") / name), 500U) << name;

  expect_refused("plan variants " + first + first, 1, "two folders have the name chin");
  expect_refused("plan variants " + first, 2, "folders");
  expect_refused("plan variants " + first + "'" + path("nowhere").string() + "'", 1, "check.json");
  fs::create_directories(path("plans") / "bad/check");
  const auto expect_bad = [&](const nlohmann::json& check, const std::string& message) {
    ASSERT_TRUE(io::write_text(path("plans") / "bad/check/check.json", check.dump()));
    expect_refused("plan variants " + first + "'" + (path("plans") / "bad").string() + "'", 1,
                   message);
  };
  std::ifstream file(path("plans") / "less/check/check.json");
  nlohmann::json check = nlohmann::json::parse(file);
  check["movements"] = {3};
  expect_bad(check, "is damaged: check and predict the plan again");
  check.erase("inputs");
  expect_bad(check, "plans of different heads");
  check["lefort_plan_check"] = 1;
  expect_bad(check, "another version of lefort: check the plan again");
}

TEST_F(MeasureCommands, refuses_in_one_line) {
  expect_refused("cephalogram " + inputs() + "--check '" + path("nothing").string() + "'", 1,
                 "no bones of `lefort plan check`");
  expect_refused("cephalogram " + inputs() + "--norms child", 2, "--norms");
  expect_refused("airway " + inputs() + "--upper Me --lower PNS", 1, "not above the lower");
  expect_refused("airway " + inputs() + "--upper nowhere", 1, "'nowhere' is neither a landmark");
  expect_refused("airway " + inputs() + "--front 0,500,0", 1, "no airway between the limits");
  plan::Landmarks far{{"MeF-L", Vec3(0.0, 0.0, 400.0)}};
  ASSERT_TRUE(io::write_landmarks(path("far.csv"), far));
  const std::string scan = "'" + path("ct.nrrd").string() + "' --labels '" +
                           path("labels.seg.nrrd").string() + "' --quiet ";
  expect_refused("nerve " + scan + "--landmarks '" + path("far.csv").string() + "'", 1,
                 "they may be of another scan");
}

}  // namespace
}  // namespace lefort::app::test_measure_commands
