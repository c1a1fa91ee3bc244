#include <lefort/geometry/mesh_properties.h>
#include <lefort/io/read_text.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/volume_files.h>
#include <lefort/io/write_atomically.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "support/run_program.h"
#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace lefort::app::test_command_line {
namespace {

using test::run_lefort;
using test::TemporaryFolder;

std::string quoted(const std::filesystem::path& path) { return "'" + path.string() + "'"; }

/// A ball of skin with a shell of bone in it.
image::CtVolume ball_scan() {
  image::CtVolume ct;
  ct.grid.size = {40, 40, 40};
  ct.grid.spacing_mm = {5.0, 5.0, 5.0};
  for (Index k = 0; k < 40; ++k)
    for (Index j = 0; j < 40; ++j)
      for (Index i = 0; i < 40; ++i) {
        const double r_mm =
            5.0 * (Vec3(double(i), double(j), double(k)) - Vec3::Constant(19.5)).norm();
        ct.values.push_back(r_mm > 85.0                  ? std::int16_t(-1000)
                            : r_mm > 60.0 && r_mm < 75.0 ? std::int16_t(1200)
                                                         : std::int16_t(40));
      }
  return ct;
}

TEST(CommandLine, HelpNamesEveryCommandAndExitsWithZero) {
  const auto help = run_lefort("--help");
  EXPECT_EQ(help.exit_code, 0);
  for (const char* command : {"import", "segment", "field", "predict", "solve"}) {
    EXPECT_NE(help.out.find(command), std::string::npos) << command;
    const auto sub = run_lefort(std::string(command) + " --help");
    EXPECT_EQ(sub.exit_code, 0);
    EXPECT_FALSE(sub.out.empty());
  }
  EXPECT_NE(help.out.find("not for clinical use"), std::string::npos);
}

TEST(CommandLine, WrongUsageExitsWithTwoAndOneLine) {
  for (const char* arguments :
       {"", "operate", "import", "import a.nrrd", "field", "field build a.stl -o a.field --band -1",
        "field build a.stl -o a.field --resolution 100", "--threads x import a -o b",
        "predict plan.json -o out --hue red"}) {
    const auto run = run_lefort(arguments);
    EXPECT_EQ(run.exit_code, 2) << arguments;
    EXPECT_EQ(std::count(run.error.begin(), run.error.end(), '\n'), 1) << run.error;
  }
}

TEST(CommandLine, ImportReadsAVolumeAndSaysWhatItIs) {
  const TemporaryFolder folder;
  ASSERT_TRUE(io::write_volume(folder / "scan.nii.gz", ball_scan()));
  const auto run = run_lefort("import " + quoted(folder / "scan.nii.gz") + " -o " +
                              quoted(folder / "ct.nrrd") + " --json --quiet");
  ASSERT_EQ(run.exit_code, 0) << run.error;
  const auto json = nlohmann::json::parse(run.out);
  EXPECT_EQ(json["size_voxels"], (std::vector<int>{40, 40, 40}));
  EXPECT_EQ(json["spacing_mm"][2], 5.0);
  EXPECT_TRUE(std::filesystem::exists(folder / "ct.nrrd"));
}

/// In Chrome's format: complete events with times in microseconds.
TEST(CommandLine, AProfileHasTheStagesOfACommand) {
  const TemporaryFolder folder;
  ASSERT_TRUE(io::write_volume(folder / "ct.nrrd", ball_scan()));
  const std::string segment = "segment " + quoted(folder / "ct.nrrd") + " -o " +
                              quoted(folder / "anatomy") + " --quiet --profile ";
  ASSERT_EQ(run_lefort(segment + quoted(folder / "profile.json")).exit_code, 0);
  const auto profile =
      nlohmann::json::parse(io::read_text(folder / "profile.json", 1 << 20).value())["traceEvents"];
  bool has_stage = false;
  for (const auto& event : profile) {
    EXPECT_EQ(event["ph"], "X");
    EXPECT_GE(event["dur"].get<double>(), 0.0);
    has_stage = has_stage || event["name"] == "segment tissues";
  }
  EXPECT_TRUE(has_stage);
  const auto unwritable = run_lefort(segment + quoted(folder / "none/profile.json"));
  EXPECT_EQ(unwritable.exit_code, 1);
  EXPECT_NE(unwritable.error.find("none/profile.json"), std::string::npos) << unwritable.error;
}

TEST(CommandLine, SegmentWritesLabelsAndClosedSurfaces) {
  const TemporaryFolder folder;
  ASSERT_TRUE(io::write_volume(folder / "ct.nrrd", ball_scan()));
  const auto run = run_lefort("segment " + quoted(folder / "ct.nrrd") + " -o " +
                              quoted(folder / "anatomy") + " --json --quiet");
  ASSERT_EQ(run.exit_code, 0) << run.error;
  EXPECT_TRUE(std::filesystem::exists(folder / "anatomy/labels.seg.nrrd"));
  const auto skull = io::read_surface(folder / "anatomy/skull.vtp");
  ASSERT_TRUE(skull) << skull.error().message;
  EXPECT_GT(skull->triangle_count(), 1000);
  const auto skin = io::read_surface(folder / "anatomy/skin.vtp");
  ASSERT_TRUE(skin) << skin.error().message;
  for (const geometry::TriangleMesh* surface : {&*skull, &*skin}) {
    const auto open_edge = geometry::first_open_edge(*surface);
    EXPECT_FALSE(open_edge) << geometry::describe(*open_edge);
  }
  EXPECT_GT(nlohmann::json::parse(run.out)["volumes_ml"]["brain"], 0.0);
}

/// The distance of a surface from the isosurface is reported, and is less than half a voxel.
TEST(CommandLine, SegmentSmoothsAndDecimatesAndReportsTheError) {
  const TemporaryFolder folder;
  ASSERT_TRUE(io::write_volume(folder / "ct.nrrd", ball_scan()));
  const auto surfaces = [&](const std::string& options) {
    const auto run = run_lefort("segment " + quoted(folder / "ct.nrrd") + " -o " +
                                quoted(folder / "anatomy") + " --json --quiet " + options);
    EXPECT_EQ(run.exit_code, 0) << run.error;
    return nlohmann::json::parse(run.out);
  };
  const double half_voxel_mm = 0.5 * ball_scan().grid.spacing_mm.minCoeff();
  const auto raw = surfaces("--smooth 0");
  EXPECT_EQ(raw["skull"]["max_off_isosurface_mm"], 0.0);
  const auto coarse = surfaces("--max-triangles 1000");
  for (const char* name : {"skull", "skin"}) {
    EXPECT_LE(coarse[name]["triangles"], 1000);
    EXPECT_GT(raw[name]["triangles"], 1000);
    EXPECT_TRUE(coarse[name]["closed"]);
    EXPECT_EQ(coarse[name]["self_intersections"], 0);
    EXPECT_GT(coarse[name]["p99_off_isosurface_mm"], 0.0);
    EXPECT_LT(coarse[name]["p99_off_isosurface_mm"].get<double>(), half_voxel_mm);
  }
  for (const char* wrong : {"--max-triangles 3", "--max-triangles many", "--smooth -1"})
    EXPECT_EQ(run_lefort("segment x -o y " + std::string(wrong)).exit_code, 2) << wrong;
}

/// Former names of options do the same with a warning; both names are a usage error.
TEST(CommandLine, DeprecatedOptionsAreAcceptedWithAWarning) {
  const TemporaryFolder folder;
  ASSERT_TRUE(io::write_surface(folder / "ball.stl", test::make_icosphere(10.0, 3)));
  const auto build = [&](const std::string& options) {
    return run_lefort("field build " + quoted(folder / "ball.stl") + " -o " +
                      quoted(folder / "ball.field") + " --resolution 16 --json --quiet " + options);
  };
  const auto now = build("--domain-size 64 --band 8"), before = build("--side 64 --band 8");
  ASSERT_EQ(now.exit_code, 0) << now.error;
  ASSERT_EQ(before.exit_code, 0) << before.error;
  EXPECT_EQ(now.out, before.out);
  EXPECT_EQ(nlohmann::json::parse(now.out)["cell_mm"], 4.0);
  EXPECT_EQ(now.error, "");
  EXPECT_EQ(before.error, "warning: --side is deprecated, use --domain-size\n");
  EXPECT_EQ(build("--side 64 --domain-size 64").exit_code, 2);
  EXPECT_EQ(build("--side -1").exit_code, 2);
  EXPECT_EQ(run_lefort("field build --help").out.find("--side"), std::string::npos);
}

TEST(CommandLine, FieldIsBuiltAndQueried) {
  const TemporaryFolder folder;
  ASSERT_TRUE(io::write_surface(folder / "ball.stl", test::make_icosphere(10.0, 5)));
  const auto built =
      run_lefort("field build " + quoted(folder / "ball.stl") + " -o " +
                 quoted(folder / "ball.field") + " --resolution 64 --band 2 --smooth --json");
  ASSERT_EQ(built.exit_code, 0) << built.error;
  EXPECT_TRUE(nlohmann::json::parse(built.out)["closed"]);
  ASSERT_TRUE(io::write_text(folder / "points.csv", "x,y,z\n11,0,0\n0 0 9.5\n0,0,0\n50 0 0\n"));
  for (const char* smooth : {"", " --smooth"}) {
    const auto queried =
        run_lefort("field query " + quoted(folder / "ball.field") + " " +
                   quoted(folder / "points.csv") + " -o " + quoted(folder / "d.csv") + smooth);
    ASSERT_EQ(queried.exit_code, 0) << queried.error;
    std::istringstream table(io::read_text(folder / "d.csv", 1000).value());
    std::vector<std::string> rows;
    for (std::string row; std::getline(table, row);) rows.push_back(row);
    ASSERT_EQ(rows.size(), 5U);
    EXPECT_EQ(rows[0],
              "x_mm,y_mm,z_mm,distance_mm,gradient_x,gradient_y,gradient_z,inside_band,zone");
    double x, y, z, distance, gradient_x;
    ASSERT_EQ(
        std::sscanf(rows[1].c_str(), "%lf,%lf,%lf,%lf,%lf", &x, &y, &z, &distance, &gradient_x), 5);
    EXPECT_NEAR(distance, 1.0, 0.03);
    EXPECT_NEAR(gradient_x, 1.0, 0.03);
    EXPECT_TRUE(rows[2].ends_with("1,band"));
    EXPECT_TRUE(rows[3].ends_with("0,inside"));
    EXPECT_TRUE(rows[4].ends_with("0,outside"));
  }
}

TEST(CommandLine, AFieldIsExportedSlicedAndDescribed) {
  const TemporaryFolder folder;
  ASSERT_TRUE(
      io::write_surface(folder / "ball.stl", test::make_icosphere(10.0, 4, Vec3(40, -30, 20))));
  const std::string field = quoted(folder / "ball.field");
  ASSERT_EQ(run_lefort("field build " + quoted(folder / "ball.stl") + " -o " + field +
                       " --resolution 64 --band 2 --smooth")
                .exit_code,
            0);
  const auto json_of = [&](const std::string& arguments) {
    const auto run = run_lefort("field " + arguments + " --json --quiet");
    EXPECT_EQ(run.exit_code, 0) << run.error;
    return nlohmann::json::parse(run.out);
  };

  const auto info = json_of("info " + field);
  EXPECT_EQ(info["kind"], "bricks");
  EXPECT_EQ(info["checksum"], "ok");
  EXPECT_TRUE(info["closed"] && info["smooth"]);
  EXPECT_EQ(info["band_mm"], 2.0);
  EXPECT_EQ(info["surface"]["components"], 1);
  EXPECT_EQ(info["surface"]["triangles"], 20 * 256);
  EXPECT_EQ(info["surface"]["flipped_triangles"], 0);
  EXPECT_GT(info["memory_bytes"]["codes"], 10'000);
  EXPECT_GT(info["memory_bytes"]["smooth_lattice"], 10'000);
  const auto reported = run_lefort("field info " + field);
  EXPECT_NE(reported.out.find("checksum ok"), std::string::npos);
  EXPECT_NE(reported.out.find("closed"), std::string::npos);

  for (const char* name : {"ball.vdb", "ball.nrrd"}) {
    const auto exported =
        json_of("export " + field + " -o " + quoted(folder / name) + " --region 20 50 -30 0 0 50");
    EXPECT_EQ(exported["samples_unknown"], 0);
    EXPECT_GT(exported["samples_in_band"], 1000);
    EXPECT_TRUE(std::filesystem::exists(folder / name));
  }
  const auto half =
      json_of("export " + field + " -o " + quoted(folder / "half.nrrd") + " --stride 2");
  EXPECT_EQ(half["samples"], (std::vector<int>{33, 33, 33}));

  const auto slice = json_of("slice " + field + " -o " + quoted(folder / "slice.png") +
                             " --axis z --at 20 --width 400 --mesh " + quoted(folder / "ball.stl"));
  EXPECT_NEAR(slice["zero_line_mm"].get<double>(), 2 * 3.14159 * 10, 0.5);
  EXPECT_NEAR(slice["inside_mm2"].get<double>(), 3.14159 * 100, 3.0);
  EXPECT_EQ(slice["pixels"][0], 400);
  EXPECT_TRUE(io::read_text(folder / "slice.png", 10'000'000)->starts_with("\x89PNG"));
  const auto samples = json_of("slice " + field + " -o " + quoted(folder / "slice.png") +
                               " --axis x --at 40 --stride 1 --smooth");
  EXPECT_EQ(samples["pixels"], (std::vector<int>{64, 64}));
  EXPECT_EQ(samples["plane"], "sagittal");
}

/// One line on stderr that names the fault, exit code 1, and nothing left in the folder.
void expect_clean_failure(const test::ProgramRun& run, const std::string& what,
                          const TemporaryFolder& folder, long entries_before) {
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_EQ(run.message_lines(), 1) << run.error;
  EXPECT_NE(run.error.find(what), std::string::npos) << run.error;
  EXPECT_EQ(folder.entry_count(), entries_before);
}

TEST(CommandLine, AnErrorOfAFieldIsOneLine) {
  const TemporaryFolder folder;
  ASSERT_TRUE(io::write_surface(folder / "ball.stl", test::make_icosphere(10.0, 2)));
  const std::string field = quoted(folder / "ball.field");
  ASSERT_EQ(
      run_lefort("field build " + quoted(folder / "ball.stl") + " -o " + field + " --resolution 32")
          .exit_code,
      0);
  ASSERT_TRUE(io::write_text(folder / "bad.field",
                             io::read_text(folder / "ball.field", 1'000'000)->substr(0, 5000)));
  const long before = folder.entry_count();
  const auto expect_line = [&](const std::string& arguments, const std::string& what) {
    SCOPED_TRACE(arguments);
    expect_clean_failure(run_lefort("field " + arguments), what, folder, before);
  };
  const std::string to = " -o " + quoted(folder / "out");
  expect_line("info " + quoted(folder / "bad.field"), "checksum");
  expect_line("export " + field + to + ".vti", ".vdb or .nrrd");
  expect_line("export " + field + to + ".nrrd --region 90 99 0 1 0 1", "region");
  expect_line("export " + field + to + ".nrrd --region 5 1 0 1 0 1", "upwards");
  expect_line("export " + field + to + ".vdb --stride 16", "level set");
  expect_line("slice " + field + to + ".jpg --axis z --at 0", ".png");
  expect_line("slice " + field + to + ".png --axis z --at 99", "z = 99");
  expect_line("slice " + field + to + ".png --axis z --at 0 --smooth", "smooth");
  expect_line("slice " + field + to + ".png --axis z --at 0 --width 9999 --region 0 1 -9 9 0 1",
              "may be at most 888 pixels wide");
  const test::ProgramRun wrong_axis =
      run_lefort("field slice " + field + to + ".png --axis w --at 0");
  EXPECT_EQ(wrong_axis.exit_code, 2);
  EXPECT_NE(wrong_axis.error.find("w not in {x,y,z}"), std::string::npos) << wrong_axis.error;
  const test::ProgramRun help = run_lefort("field build --help");
  EXPECT_NE(help.out.find("{adaptive,bricks,hybrid,uniform}"), std::string::npos);
  EXPECT_EQ(run_lefort("field slice " + field + to + ".png --axis z --at 0 --width 99 --stride 1")
                .exit_code,
            2);
  EXPECT_EQ(run_lefort("field export " + field + to + ".vdb --region 1 2 3").exit_code, 2);
}

TEST(CommandLine, BadInputIsOneLineAndLeavesNothing) {
  const TemporaryFolder folder;
  ASSERT_TRUE(io::write_text(folder / "garbage.nrrd", "NRRD0004\nnonsense"));
  ASSERT_TRUE(io::write_text(folder / "garbage.stl", "solid nothing"));
  ASSERT_TRUE(io::write_text(folder / "garbage.field", "LEFO"));
  ASSERT_TRUE(io::write_text(folder / "points.csv", "1 2\n"));
  const long before = folder.entry_count();
  const std::string out = quoted(folder / "out");
  expect_clean_failure(run_lefort("import /nonexistent -o " + quoted(folder / "o.nrrd")),
                       "the scan does not exist", folder, before);
  // Not the file's name, which is the patient's often enough.
  expect_clean_failure(
      run_lefort("import " + quoted(folder / "garbage.nrrd") + " -o " + quoted(folder / "o.nrrd")),
      "NRRD file: line 2 of the header", folder, before);
  expect_clean_failure(run_lefort("segment " + quoted(folder / "garbage.nrrd") + " -o " + out),
                       "NRRD file: line 2 of the header", folder, before);
  expect_clean_failure(run_lefort("field build " + quoted(folder / "garbage.stl") + " -o " + out),
                       "garbage.stl", folder, before);
  expect_clean_failure(run_lefort("field query " + quoted(folder / "garbage.field") + " " +
                                  quoted(folder / "points.csv") + " -o " + out),
                       "garbage.field", folder, before);
}

TEST(CommandLine, AnOutputThatCannotBeWrittenIsOneLine) {
  const TemporaryFolder folder;
  ASSERT_TRUE(io::write_volume(folder / "ct.nrrd", ball_scan()));
  const auto run =
      run_lefort("import " + quoted(folder / "ct.nrrd") + " -o /nonexistent/folder/o.nrrd");
  expect_clean_failure(run, "/nonexistent/folder/o.nrrd", folder, 1);
  expect_clean_failure(
      run_lefort("segment " + quoted(folder / "ct.nrrd") + " -o /proc/nothing/here"),
      "/proc/nothing/here", folder, 1);
}

TEST(CommandLine, AWholeVerificationReportIsNotReplacedByAPart) {
  const TemporaryFolder folder;
  const std::string report = "# Verification\n\nMade by `lefort verify --full`: tables.\n";
  ASSERT_TRUE(io::write_text(folder / "verification.md", report));
  expect_clean_failure(run_lefort("verify --only patch -o " + quoted(folder.path())),
                       "made by `lefort verify --full`", folder, 1);
  EXPECT_EQ(io::read_text(folder / "verification.md", 1000).value(), report);
}

TEST(CommandLine, AFullDiskIsOneLineAndLeavesNoPartOfAFile) {
  const TemporaryFolder folder;
  image::CtVolume noisy = ball_scan();  // Does not compress below the limit.
  std::uint32_t state = 1;
  for (std::int16_t& value : noisy.values) {
    state = state * 1664525U + 1013904223U;
    value = std::int16_t(state >> 21);
  }
  ASSERT_TRUE(io::write_volume(folder / "ct.nrrd", noisy));
  const auto run =
      run_lefort("import " + quoted(folder / "ct.nrrd") + " -o " + quoted(folder / "o.nrrd"),
                 "trap '' XFSZ; ulimit -f 20;");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_EQ(run.message_lines(), 1) << run.error;
  EXPECT_EQ(folder.entry_count(), 1);
}

TEST(CommandLine, AFullDiskLeavesNoPartOfAnExportOrASlice) {
  const TemporaryFolder folder;
  ASSERT_TRUE(io::write_surface(folder / "ball.stl", test::make_icosphere(20, 3)));
  const std::string field = quoted(folder / "ball.field");
  ASSERT_EQ(
      run_lefort("field build " + quoted(folder / "ball.stl") + " -o " + field + " --resolution 64")
          .exit_code,
      0);
  for (const std::string& command :
       {"export " + field + " -o " + quoted(folder / "o.vdb"),
        "export " + field + " -o " + quoted(folder / "o.nrrd"),
        "slice " + field + " -o " + quoted(folder / "o.png") + " --axis z --at 0"}) {
    const auto run = run_lefort("field " + command + " --quiet", "trap '' XFSZ; ulimit -f 20;");
    EXPECT_EQ(run.exit_code, 1) << command;
    EXPECT_EQ(std::count(run.error.begin(), run.error.end(), '\n'), 1) << run.error;
    EXPECT_EQ(folder.entry_count(), 2);
  }
}

TEST(CommandLine, APlanIsCheckedBeforeAnythingIsDone) {
  const TemporaryFolder folder;
  ASSERT_TRUE(io::write_volume(folder / "ct.nrrd", ball_scan()));
  const std::string segments =
      R"("segments":[{"name":"m","osteotomy":{"planes":[{"point_mm":[0,0,0],"towards_segment":[0,-1,0]}]},)"
      R"("path":{"keyframes":[{"translation_mm":[0,-6,0]}]}}])";
  ASSERT_TRUE(
      io::write_text(folder / "unknown.json", R"({"lefort_plan":1,"hue":"red",)" + segments + "}"));
  ASSERT_TRUE(io::write_text(folder / "lost.json",
                             R"({"lefort_plan":1,"ct":"lost.nrrd",)" + segments + "}"));
  const long before = folder.entry_count();
  const std::string to = " -o " + quoted(folder / "out");
  expect_clean_failure(run_lefort("predict " + quoted(folder / "unknown.json") + to), "'hue'",
                       folder, before);
  expect_clean_failure(run_lefort("predict " + quoted(folder / "lost.json") + to), "lost.nrrd",
                       folder, before);
  expect_clean_failure(run_lefort("predict " + quoted(folder / "none.json") + to), "none.json",
                       folder, before);
}

}  // namespace
}  // namespace lefort::app::test_command_line
