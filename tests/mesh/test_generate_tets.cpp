#include <lefort/core/check.h>
#include <lefort/geometry/mesh_properties.h>
#include <lefort/mesh/boundary_faces.h>
#include <lefort/mesh/element_quality.h>
#include <lefort/mesh/generate_tets.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <new>
#include <numbers>
#include <string>
#include <vector>

namespace lefort::mesh::test_generate_tets {
namespace {

using Level = std::function<double(const Vec3&)>;

Box3 cube(double half_mm) {
  return {Vec3(-half_mm, -half_mm, -half_mm), Vec3(half_mm, half_mm, half_mm)};
}

Level ball(double radius_mm, const Vec3& center = Vec3::Zero()) {
  return [=](const Vec3& p) { return radius_mm - (p - center).norm(); };
}

Level torus(double major_mm, double minor_mm) {
  return [=](const Vec3& p) {
    return minor_mm - std::hypot(std::hypot(p.x(), p.y()) - major_mm, p.z());
  };
}

geometry::TriangleMesh surface_of(const VolumeMesh& mesh) {
  geometry::TriangleMesh surface;
  surface.vertices = mesh.nodes_L;
  surface.triangles = triangles_of(boundary_faces(mesh));
  return surface;
}

/// Checks the postconditions of every mesh, for level-set functions that are distances.
void expect_sound(const VolumeMesh& mesh, const Level& level, double tolerance_mm) {
  ASSERT_EQ(mesh.blocks.size(), 1u);
  const MeshQuality quality = measure_quality(mesh);
  EXPECT_TRUE(quality.inverted.empty());
  EXPECT_GT(quality.min_dihedral_deg, 8.0);
  const geometry::TriangleMesh surface = surface_of(mesh);
  EXPECT_TRUE(geometry::is_closed(surface));
  EXPECT_NEAR(geometry::signed_volume_mm3(surface), quality.volume_mm3, 1e-9 * quality.volume_mm3);
  for (const std::int32_t node : nodes_of_faces(boundary_faces(mesh)))
    EXPECT_NEAR(level(mesh.nodes_L[std::size_t(node)]), 0.0, tolerance_mm);
  std::vector<bool> used(mesh.nodes_L.size(), false);
  for (const std::int32_t node : mesh.blocks[0].nodes) used[std::size_t(node)] = true;
  EXPECT_EQ(std::count(used.begin(), used.end(), false), 0);
}

TEST(GenerateTets, FillsABall) {
  const auto mesh =
      generate_tets(ball(20.0), cube(22.0), {.element_size_mm = 4.0, .surface_distance_mm = 0.2});
  ASSERT_TRUE(mesh) << mesh.error().message;
  expect_sound(*mesh, ball(20.0), 0.01);
  const double expected = 4.0 / 3.0 * std::numbers::pi * 8000.0;
  EXPECT_NEAR(measure_quality(*mesh).volume_mm3, expected, 0.02 * expected);
  EXPECT_EQ(geometry::euler_characteristic(surface_of(*mesh)), 2);
}

TEST(GenerateTets, FillsATorus) {
  const auto mesh = generate_tets(torus(15.0, 5.0), cube(22.0),
                                  {.element_size_mm = 2.5, .surface_distance_mm = 0.1});
  ASSERT_TRUE(mesh) << mesh.error().message;
  expect_sound(*mesh, torus(15.0, 5.0), 0.01);
  const double expected = 2.0 * std::numbers::pi * std::numbers::pi * 15.0 * 25.0;
  EXPECT_NEAR(measure_quality(*mesh).volume_mm3, expected, 0.03 * expected);
  EXPECT_EQ(geometry::euler_characteristic(surface_of(*mesh)), 0);
}

TEST(GenerateTets, MeshEndsAtTheBoxIfTheLevelIsPositiveThere) {
  const auto mesh =
      generate_tets([](const Vec3&) { return 1.0; }, cube(10.0), {.element_size_mm = 3.0});
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_TRUE(measure_quality(*mesh).inverted.empty());
  EXPECT_NEAR(measure_quality(*mesh).volume_mm3, 8000.0, 0.03 * 8000.0);
}

TEST(GenerateTets, FollowsTheSizeField) {
  const auto size = [](const Vec3& p) { return p.x() > 0.0 ? 1.5 : 4.0; };
  const auto mesh =
      generate_tets(ball(12.0), cube(14.0), {.element_size_mm = 4.0, .size_at_mm = size});
  ASSERT_TRUE(mesh) << mesh.error().message;
  const ElementBlock& block = mesh->blocks[0];
  double fine_mm3 = 0.0, coarse_mm3 = 0.0;
  Index fine = 0, coarse = 0;
  for (Index e = 0; e < block.element_count(); ++e) {
    const auto p = [&](int n) { return mesh->nodes_L[std::size_t(block.element(e)[n])]; };
    const double x = (p(0) + p(1) + p(2) + p(3)).x() / 4.0;
    const double volume_mm3 = tet_quality(p(0), p(1), p(2), p(3)).volume_mm3;
    if (x > 2.0) ++fine, fine_mm3 += volume_mm3;
    if (x < -4.0) ++coarse, coarse_mm3 += volume_mm3;
  }
  EXPECT_LT(fine_mm3 / double(fine), 0.25 * coarse_mm3 / double(coarse));
}

/// A large ball on the right, and one of `radius_mm` on the left.
Level two_balls(double radius_mm) {
  return [=](const Vec3& p) {
    return std::max(ball(10.0, {-11, 0, 0})(p), ball(radius_mm, {12, 0, 0})(p));
  };
}

TEST(GenerateTets, KeepsTheLargestPartAndReportsTheOmittedVolume) {
  class Notes : public Progress {
   public:
    void note(std::string_view sentence) override { sentences.emplace_back(sentence); }
    std::vector<std::string> sentences;
  } notes;
  const auto mesh = generate_tets(two_balls(3.5), cube(25.0), {.element_size_mm = 2.0}, notes);
  ASSERT_TRUE(mesh) << mesh.error().message;
  for (const Vec3& p : mesh->nodes_L) EXPECT_LT(p.x(), 0.0);
  // 43 of 1043 parts of volume.
  ASSERT_GE(notes.sentences.size(), 1U);
  EXPECT_NE(notes.sentences[0].find("of tissue (3"), std::string::npos) << notes.sentences[0];
}

TEST(GenerateTets, FailsIfMoreThanFragmentsWouldBeOmitted) {
  const auto mesh = generate_tets(two_balls(5.0), cube(25.0), {.element_size_mm = 2.0});
  ASSERT_FALSE(mesh);  // 125 of 1125 parts of volume.
  EXPECT_EQ(mesh.error().code, ErrorCode::kMeshingFailed);
  EXPECT_NE(mesh.error().message.find("expected at most 5 %"), std::string::npos)
      << mesh.error().message;
}

TEST(GenerateTets, ReportsExhaustedMemoryAndRethrowsOtherExceptions) {
  const auto starved =
      generate_tets([](const Vec3&) -> double { throw std::bad_alloc(); }, cube(10.0));
  ASSERT_FALSE(starved);
  EXPECT_EQ(starved.error().code, ErrorCode::kMeshingFailed);
  EXPECT_NE(starved.error().message.find("memory"), std::string::npos) << starved.error().message;
  const Level with_a_bug = [](const Vec3&) -> double {
    LEFORT_CHECK(1 + 1 == 3);
    return 0.0;
  };
  EXPECT_THROW(static_cast<void>(generate_tets(with_a_bug, cube(10.0))), LogicError);
}

TEST(GenerateTets, FindsAPartAwayFromTheCenter) {
  const auto mesh = generate_tets(ball(5.0, {40, 40, -40}), cube(50.0), {.element_size_mm = 2.5});
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_GT(mesh->element_count(), 100);
}

TEST(GenerateTets, SameInputSameBytes) {
  const TetOptions options{.element_size_mm = 3.0};
  const auto once = generate_tets(torus(15.0, 5.0), cube(22.0), options);
  const auto again = generate_tets(torus(15.0, 5.0), cube(22.0), options);
  ASSERT_TRUE(once && again);
  EXPECT_EQ(once->nodes_L, again->nodes_L);
  EXPECT_EQ(once->blocks[0].nodes, again->blocks[0].nodes);
}

void expect_error(const Result<VolumeMesh>& mesh, ErrorCode code, const std::string& words) {
  ASSERT_FALSE(mesh);
  EXPECT_EQ(mesh.error().code, code);
  EXPECT_NE(mesh.error().message.find(words), std::string::npos) << mesh.error().message;
}

TEST(GenerateTets, ReportsAnEmptyRegion) {
  expect_error(generate_tets([](const Vec3&) { return -1.0; }, cube(10.0)),
               ErrorCode::kMeshingFailed, "at 0 points");
  expect_error(generate_tets([](const Vec3&) { return std::nan(""); }, cube(10.0)),
               ErrorCode::kMeshingFailed, "at 0 points");
}

TEST(GenerateTets, RejectsOptionsOutOfRange) {
  const auto with = [](const TetOptions& options) {
    return generate_tets(ball(5.0), cube(10.0), options);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto code = ErrorCode::kInvalidArgument;
  expect_error(with({.element_size_mm = 0.0}), code, "element_size_mm");
  expect_error(with({.element_size_mm = nan}), code, "element_size_mm");
  expect_error(with({.element_size_mm = 1e-4}), code, "element_size_mm");
  expect_error(with({.surface_distance_mm = 0.0}), code, "surface_distance_mm");
  expect_error(with({.facet_angle_deg = 40.0}), code, "facet_angle_deg");
  expect_error(with({.cell_radius_edge = 1.0}), code, "cell_radius_edge");
  expect_error(with({.sliver_angle_deg = -1.0}), code, "sliver_angle_deg");
  expect_error(with({.level_tolerance_mm = 0.0}), code, "level_tolerance_mm");
  expect_error(generate_tets(ball(5.0), Box3()), code, "box");
  expect_error(generate_tets(ball(5.0), cube(nan)), code, "box");
  expect_error(generate_tets(ball(5.0), cube(1e30)), code, "box");
}

class StopAfter : public Progress {
 public:
  explicit StopAfter(int looks) : left_(looks) {}
  [[nodiscard]] bool stop_requested() const override { return left_-- <= 0; }

 private:
  mutable int left_;
};

TEST(GenerateTets, StopsOnRequestInAnyPhase) {
  for (const int looks : {0, 3, 12, 40}) {
    StopAfter stop(looks);
    expect_error(generate_tets(ball(20.0), cube(22.0), {.element_size_mm = 3.0}, stop),
                 ErrorCode::kCancelled, "cancelled");
  }
}

}  // namespace
}  // namespace lefort::mesh::test_generate_tets
