/// \file
/// `lefort compare`, as a user runs it: two surfaces, and an operation that is found again in a
/// scan after it.
#include <lefort/core/parallel.h>
#include <lefort/core/units.h>
#include <lefort/geometry/rigid_motion.h>
#include <lefort/image/volume.h>
#include <lefort/io/read_text.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/transform_file.h>
#include <lefort/io/volume_files.h>
#include <lefort/io/write_atomically.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "support/result_file.h"
#include "support/run_program.h"
#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace lefort::app::test_compare_command {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::string quoted(const fs::path& path) { return "'" + path.string() + "'"; }

class CompareCommand : public testing::Test {
 protected:
  json result() { return test::read_result(folder_ / "out/compare.json", "compare"); }
  test::ProgramRun compare(const std::string& arguments) {
    return test::run_lefort("--quiet compare " + arguments + " -o " + quoted(folder_ / "out"));
  }
  /// compare.json of the scan after.nrrd with the face that is predicted from before.nrrd.
  json compared(const std::string& segments) {
    EXPECT_TRUE(io::write_text(folder_ / "plan.json",
                               R"({"lefort_plan": 1, "ct": "before.nrrd", "segments": )" +
                                   segments +
                                   R"(, "tissue": {"element_size_mm": 8, "margin_mm": 10},
                                      "field": {"resolution": 64, "band_mm": 4}})"));
    const auto predicted = test::run_lefort("--quiet predict " + quoted(folder_ / "plan.json") +
                                            " --no-pictures -o " + quoted(folder_ / "prediction"));
    EXPECT_EQ(predicted.exit_code, 0) << predicted.error;
    const auto run = compare(quoted(folder_ / "prediction") + " --after-ct " +
                             quoted(folder_ / "after.nrrd") + " --no-pictures");
    EXPECT_EQ(run.exit_code, 0) << run.error;
    return run.exit_code == 0 ? result() : json{{"movements", json::array()}};
  }
  test::TemporaryFolder folder_;
};

TEST_F(CompareCommand, ReportsTheDistanceBetweenTwoSurfaces) {
  ASSERT_TRUE(io::write_surface(folder_ / "a.stl", test::make_icosphere(52.0, 4)));
  ASSERT_TRUE(io::write_surface(folder_ / "b.ply", test::make_icosphere(50.0, 4)));
  ASSERT_TRUE(io::write_surface(folder_ / "before.vtp", test::make_icosphere(47.0, 4)));
  const auto run = compare(quoted(folder_ / "a.stl") + " " + quoted(folder_ / "b.ply") +
                           " --before " + quoted(folder_ / "before.vtp"));
  ASSERT_EQ(run.exit_code, 0) << run.error;
  const json found = result();
  EXPECT_EQ(found["regions"][0]["region"], "whole");
  EXPECT_NEAR(found["regions"][0]["face"]["mean_signed_mm"].get<double>(), 2.0, 0.05);
  EXPECT_NEAR(found["regions"][0]["baseline_no_change"]["mean_signed_mm"].get<double>(), -3.0,
              0.05);
  EXPECT_EQ(found["regions"][0]["face"]["fraction_below_1mm"], 0.0);
  for (const char* file : {"regions.csv", "difference.vtp", "pictures/difference_front.png"})
    EXPECT_TRUE(fs::exists(folder_ / "out" / file)) << file;
  EXPECT_NE(run.out.find("no change"), std::string::npos) << run.out;
}

TEST_F(CompareCommand, BadInputGetsOneLineAndLosesNothing) {
  const fs::path mine = folder_ / "out/difference.vtp";
  fs::create_directories(folder_ / "out");
  ASSERT_TRUE(io::write_surface(mine, test::make_icosphere(50.0, 2)));
  ASSERT_TRUE(io::write_surface(folder_ / "far.stl", test::make_icosphere(5.0, 2, {900, 0, 0})));
  ASSERT_TRUE(io::write_text(folder_ / "bad.stl", "solid nothing"));
  fs::create_directories(folder_ / "empty");
  const auto refused = [&](const std::string& arguments, const std::string& says) {
    const auto run = compare(arguments);
    EXPECT_EQ(run.exit_code, 1) << arguments;
    EXPECT_EQ(run.message_lines(), 1) << run.error;
    EXPECT_NE(run.error.find(says), std::string::npos) << run.error;
    EXPECT_TRUE(fs::exists(mine));
    EXPECT_FALSE(fs::exists(folder_ / "out/compare.json"));
  };
  const std::string here = quoted(mine), bad = quoted(folder_ / "bad.stl");
  refused(here + " " + here, "difference.vtp");  // Its own output.
  ASSERT_TRUE(io::write_surface(folder_ / "a.stl", test::make_icosphere(50.0, 2)));
  const std::string a = quoted(folder_ / "a.stl");
  refused(a, "--after-ct");
  refused(a + " " + quoted(folder_ / "empty"), "prediction.json");
  refused(a + " --after-ct " + a, "folder of a prediction");
  refused(bad + " " + a, "bad.stl");
  fs::rename(mine, folder_ / "kept.vtp");
  const auto run = compare(a + " " + quoted(folder_ / "far.stl"));
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.error.find("same frame"), std::string::npos) << run.error;
  EXPECT_FALSE(fs::exists(folder_ / "out/compare.json"));
}

/// A head without symmetry: skin around a shell of bone.
struct Head {
  RigidTransform X_LB = RigidTransform::Identity();  ///< Of the bone in front of y = -20.
  std::optional<RigidTransform> X_left_LB{};  ///< Of what of it is on the left, if it is cut off.

  /// Roughly how far beyond an uneven ellipsoid, 0.8 and 1.2 times as wide and as deep as high.
  static double beyond_mm(const Vec3& p, double radius_mm) {
    const Vec3 stretched = p.cwiseQuotient(Vec3(0.8, 1.2, 1.0));
    const double r = std::max(stretched.norm(), 1e-9);
    const Vec3 d = stretched / r;
    const double height = 1.0 + 0.08 * std::sin(4.0 * d.x() + 1.0) +
                          0.06 * std::cos(5.0 * d.y() + 3.0 * d.z()) + 0.1 * d.x() * d.z();
    return (r - radius_mm * height) * p.norm() / r;
  }
  static double depth_in_shell_mm(const Vec3& p) {
    return std::min(-beyond_mm(p, 51.0), beyond_mm(p, 40.0));
  }
  /// HU; a voxel on a border is a mixture of both sides, as in a scanner.
  [[nodiscard]] double hu(const Vec3& p_L, double voxel_mm) const {
    const auto fraction = [&](double depth_mm) {
      return std::clamp(0.5 + depth_mm / voxel_mm, 0.0, 1.0);
    };
    const auto depth_in_front_mm = [](const Vec3& p_B) {
      return std::min(depth_in_shell_mm(p_B), -20.0 - p_B.y());
    };
    const Vec3 p_B = X_LB.inverse() * p_L;
    const double stationary_mm = std::min(depth_in_shell_mm(p_L), p_L.y() + 20.0);
    double moved_mm = depth_in_front_mm(p_B);
    if (X_left_LB) {
      const Vec3 left_B = X_left_LB->inverse() * p_L;
      moved_mm =
          std::max(std::min(moved_mm, -p_B.x()), std::min(depth_in_front_mm(left_B), left_B.x()));
    }
    const double bone = fraction(std::max(stationary_mm, moved_mm));
    const double skin = fraction(-beyond_mm(p_L, 70.0));
    return -1000.0 + 1040.0 * skin + 1160.0 * bone;
  }
  [[nodiscard]] image::CtVolume scan(Index size, double spacing_mm,
                                     const RigidTransform& X_scan_L) const {
    image::CtVolume ct;
    ct.grid.size = {size, size, size};
    ct.grid.spacing_mm = Vec3::Constant(spacing_mm);
    ct.grid.origin_L = X_scan_L.translation() - Vec3::Constant(0.5 * spacing_mm * double(size - 1));
    const RigidTransform X_L_scan = X_scan_L.inverse();
    ct.values.resize(std::size_t(ct.grid.voxel_count()));
    parallel_for(ct.grid.voxel_count(), [&](Index v) {
      const Vec3 p_V{double(v % size), double(v / size % size), double(v / (size * size))};
      ct.values[std::size_t(v)] =
          std::int16_t(std::lround(hu(X_L_scan * ct.grid.point_L(p_V), spacing_mm)));
    });
    return ct;
  }
};

RigidTransform registered(const json& movement) {
  RigidTransform X_LB;
  for (Index i = 0; i < 16; ++i)
    X_LB.matrix()(i / 4, i % 4) = movement["registration"]["matrix"][std::size_t(i)];
  return X_LB;
}

/// The achieved movement differs from the plan, and so does the position in the scanner.
TEST_F(CompareCommand, FindsTheMovementThatWasAchieved) {
  ASSERT_TRUE(
      io::write_volume(folder_ / "before.nrrd", Head{}.scan(128, 1.5, RigidTransform::Identity())));
  const RigidTransform achieved =
      geometry::rigid_motion({0.7, -2.4, -0.8}, {0.03, -0.02, 0.04}, {0, -45, 0});
  const RigidTransform other_scan =
      geometry::rigid_motion({3.0, -2.0, 1.5}, {0.12, -0.08, 0.2}, {0, 0, 0});
  ASSERT_TRUE(io::write_volume(folder_ / "after.nrrd", Head{achieved}.scan(140, 1.4, other_scan)));
  const json found = compared(R"([{
      "name": "front",
      "osteotomy": {"planes": [{"point_mm": [0, -20, 0], "towards_segment": [0, -1, 0]}]},
      "path": {"steps": 2, "keyframes": [{"translation_mm": [0, -3, 0]}]}
    }])");
  ASSERT_EQ(found["movements"].size(), 1U);
  const RigidTransform error = registered(found["movements"][0]) * achieved.inverse();
  const Vec3 front(0, -45, 0);
  EXPECT_LT((error * front - front).norm(), 0.1) << found["movements"];
  EXPECT_LT(degrees_from_radians(geometry::rotation_vector(error.linear()).norm()), 0.1);
  const auto laid_on = io::read_transform(folder_ / "out/registration.tfm");
  ASSERT_TRUE(laid_on) << laid_on.error().message;
  const RigidTransform miss = *laid_on * other_scan;
  for (const Vec3& p : {Vec3(45, 0, 0), Vec3(0, 45, 0), Vec3(0, 0, 45), Vec3(0, -45, 0)})
    EXPECT_LT((miss * p - p).norm(), 0.1);
  // The plan was 3 mm straight forward.
  const json& off = found["movements"][0]["from_plan_to_achieved"];
  EXPECT_NEAR(off["translation_mm"][1].get<double>(), 0.6, 0.2);
  EXPECT_NEAR(off["rotation_angle_deg"].get<double>(), 3.09, 0.1);
  for (const char* file : {"movements.csv", "skin_after.vtp", "bone_after.vtp"})
    EXPECT_TRUE(fs::exists(folder_ / "out" / file)) << file;
  // Its skin did not move at all: "no change" is the better prediction, and is reported as such.
  // Two scans of one surface differ by less than a quarter of a voxel.
  const double unchanged_mm = found["regions"][0]["baseline_no_change"]["p95_mm"];
  EXPECT_LT(unchanged_mm, 0.25 * 1.5);
  EXPECT_GT(found["regions"][1]["face"]["median_mm"].get<double>(), unchanged_mm);
}

TEST_F(CompareCommand, FindsTheMovementOfEachOfSeveralSegments) {
  ASSERT_TRUE(
      io::write_volume(folder_ / "before.nrrd", Head{}.scan(128, 1.5, RigidTransform::Identity())));
  const std::array achieved{
      geometry::rigid_motion({1.6, -2.6, 0.4}, {0.0, 0.02, -0.04}, {20, -40, 0}),
      geometry::rigid_motion({-1.5, -3.5, -0.5}, {0.03, 0.0, 0.03}, {-20, -40, 0})};
  ASSERT_TRUE(io::write_volume(folder_ / "after.nrrd", Head{achieved[1], achieved[0]}.scan(
                                                           128, 1.5, RigidTransform::Identity())));
  const json found = compared(R"([{
      "name": "left",
      "osteotomy": {"planes": [{"point_mm": [0, -20, 0], "towards_segment": [0, -1, 0]},
                               {"point_mm": [0, 0, 0], "towards_segment": [1, 0, 0]}]},
      "path": {"steps": 2, "keyframes": [{"translation_mm": [1.5, -3, 0]}]}
    }, {
      "name": "right",
      "osteotomy": {"planes": [{"point_mm": [0, -20, 0], "towards_segment": [0, -1, 0]}]},
      "path": {"steps": 2, "keyframes": [{"translation_mm": [-1.5, -3, 0]}]}
    }])");
  ASSERT_EQ(found["movements"].size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) {
    const json& movement = found["movements"][k];
    EXPECT_EQ(movement["segment"], k == 0 ? "left" : "right");
    const RigidTransform error = registered(movement) * achieved[k].inverse();
    const Vec3 front(k == 0 ? 20 : -20, -40, 0);
    EXPECT_LT((error * front - front).norm(), 0.15) << movement;
    EXPECT_LT(degrees_from_radians(geometry::rotation_vector(error.linear()).norm()), 0.3);
  }

  // A folder whose files are of different plans is not a prediction.
  json plan = json::parse(io::read_text(folder_ / "prediction/plan.json", 1 << 20).value());
  plan["segments"].erase(1);
  ASSERT_TRUE(io::write_text(folder_ / "prediction/plan.json", plan.dump()));
  const auto refused = compare(quoted(folder_ / "prediction") + " --after-ct " +
                               quoted(folder_ / "after.nrrd") + " --no-pictures");
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_EQ(refused.message_lines(), 1) << refused.error;
  EXPECT_NE(refused.error.find("of different plans"), std::string::npos) << refused.error;
}

}  // namespace
}  // namespace lefort::app::test_compare_command
