#include <lefort/anatomy/extract_surface.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "anatomy/mesh_checks.h"

namespace lefort::anatomy::test_extract_surface {
namespace {

using geometry::TriangleMesh;
using image::ScalarVolume;

/// level(p) on a grid of `count` voxels along each axis, centered at 0.
template <class Level>
ScalarVolume sampled(Index count, double spacing_mm, const Level& level,
                     const Mat3& direction = Mat3::Identity()) {
  ScalarVolume volume;
  volume.grid.size = {count, count, count};
  volume.grid.spacing_mm = Vec3::Constant(spacing_mm);
  volume.grid.direction = direction;
  volume.grid.origin_L = direction * Vec3::Constant(-0.5 * spacing_mm * double(count - 1));
  for (Index k = 0; k < count; ++k)
    for (Index j = 0; j < count; ++j)
      for (Index i = 0; i < count; ++i)
        volume.values.push_back(
            float(level(volume.grid.point_L({double(i), double(j), double(k)}))));
  return volume;
}

double sphere_level(const Vec3& p) { return 10.0 - p.norm(); }

double torus_level(const Vec3& p) { return 4.0 - std::hypot(p.head<2>().norm() - 10.0, p.z()); }

TEST(ExtractIsosurface, SphereIsClosedOutwardAndOfSecondOrder) {
  const double sphere_area = 4.0 * M_PI * 100.0;
  const double sphere_volume = 4.0 / 3.0 * M_PI * 1000.0;
  std::array<double, 2> area_error{};
  std::array<double, 2> volume_error{};
  for (std::size_t n = 0; n < 2; ++n) {
    const double h = n == 0 ? 1.0 : 0.5;
    const TriangleMesh mesh =
        extract_isosurface(sampled(n == 0 ? 26 : 52, h, sphere_level)).value();
    EXPECT_EQ(test::count_bad_edges(mesh), 0);
    EXPECT_EQ(test::euler_number(mesh), 2);
    area_error[n] = std::abs(test::area(mesh) / sphere_area - 1.0);
    volume_error[n] = std::abs(test::volume(mesh) / sphere_volume - 1.0);
    EXPECT_LT(volume_error[n], 0.01 * h * h);
    for (const Vec3& p : mesh.vertices) EXPECT_NEAR(p.norm(), 10.0, 0.02 * h * h);
  }
  EXPECT_NEAR(area_error[0] / area_error[1], 4.0, 0.5);
  EXPECT_NEAR(volume_error[0] / volume_error[1], 4.0, 0.5);
}

TEST(ExtractIsosurface, TorusHasTheRightTopologyAreaAndVolume) {
  const TriangleMesh mesh = extract_isosurface(sampled(62, 0.5, torus_level)).value();
  EXPECT_EQ(test::count_bad_edges(mesh), 0);
  EXPECT_EQ(test::euler_number(mesh), 0);
  EXPECT_NEAR(test::area(mesh), 4.0 * M_PI * M_PI * 40.0, 0.01 * 4.0 * M_PI * M_PI * 40.0);
  EXPECT_NEAR(test::volume(mesh), 2.0 * M_PI * M_PI * 160.0, 0.01 * 2.0 * M_PI * M_PI * 160.0);
}

TEST(ExtractIsosurface, ObliqueGridsGiveTheSameSurfaceInThePatient) {
  const Mat3 oblique = Eigen::AngleAxisd(0.7, Vec3(1.0, -2.0, 0.5).normalized()).matrix();
  const auto egg = [](const Vec3& p) {
    return 10.0 - (p - Vec3(1.0, 2.0, -1.0)).cwiseProduct(Vec3(1.0, 1.3, 0.9)).norm();
  };
  const TriangleMesh mesh = extract_isosurface(sampled(64, 0.5, egg, oblique)).value();
  EXPECT_EQ(test::count_bad_edges(mesh), 0);
  EXPECT_GT(test::volume(mesh), 0.0);
  for (const Vec3& p : mesh.vertices) EXPECT_NEAR(egg(p), 0.0, 0.02);
}

TEST(ExtractIsosurface, SurfacesThroughGridPointsHaveNoTriangleWithoutArea) {
  // Planes, corners and edges at whole numbers: a cube, and whole layers of zeros.
  const auto cube = [](const Vec3& p) { return 5.0 - p.cwiseAbs().maxCoeff(); };
  const TriangleMesh mesh = extract_isosurface(sampled(21, 1.0, cube)).value();
  EXPECT_EQ(test::count_bad_edges(mesh), 0);
  EXPECT_EQ(test::euler_number(mesh), 2);
  for (Index t = 0; t < mesh.triangle_count(); ++t)
    EXPECT_GT(test::area_vector(mesh, t).norm(), 1e-9);
  EXPECT_NEAR(test::volume(mesh), 1000.0, 2.0);
}

TEST(ExtractIsosurface, NoiseGivesAClosedSurfaceToo) {
  // All configurations of signs in a cell occur, including the ambiguous ones.
  for (const unsigned seed : {1U, 2U, 3U}) {
    std::mt19937 generator(seed);
    std::uniform_real_distribution<double> noise(-1.0, 1.0);
    const TriangleMesh mesh = extract_isosurface(sampled(24, 1.0, [&](const Vec3& p) {
                                return p.cwiseAbs().maxCoeff() > 11.0 ? -1.0 : noise(generator);
                              })).value();
    EXPECT_GT(mesh.triangle_count(), 10'000);
    EXPECT_EQ(test::count_bad_edges(mesh), 0) << "seed " << seed;
    EXPECT_GT(test::volume(mesh), 0.0);
  }
}

TEST(ExtractIsosurface, SmallComponentsAndCavitiesAreDropped) {
  const auto balls = [](const Vec3& p) {
    const double shell = std::min(10.0 - p.norm(), (p - Vec3(2, 0, 0)).norm() - 3.0);
    return std::max(shell, 2.0 - (p - Vec3(10, 10, 0)).norm());
  };
  const ScalarVolume level = sampled(64, 0.5, balls);
  const double ball = 4.0 / 3.0 * M_PI;
  EXPECT_NEAR(test::volume(extract_isosurface(level).value()), ball * (1000 - 27 + 8), 20.0);
  EXPECT_NEAR(test::volume(extract_isosurface(level, {.min_part_ml = 0.05}).value()),
              ball * (1000 - 27), 20.0);
  EXPECT_NEAR(test::volume(extract_isosurface(level, {.min_part_ml = 0.2}).value()), ball * 1000,
              20.0);
  EXPECT_EQ(extract_isosurface(level, {.min_part_ml = 10.0}).error().code, ErrorCode::kMeshInvalid);
}

TEST(ExtractIsosurface, RejectsLevelsThatAreNotClosedNotFiniteOrNotPositiveAnywhere) {
  const auto code = [](const ScalarVolume& level) {
    return extract_isosurface(level).error().code;
  };
  EXPECT_EQ(code(sampled(10, 1.0, sphere_level)), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code(sampled(10, 1.0, [](const Vec3&) { return -1.0; })), ErrorCode::kMeshInvalid);
  EXPECT_EQ(code({}), ErrorCode::kInvalidArgument);
  ScalarVolume level = sampled(26, 1.0, sphere_level);
  level.values.pop_back();
  EXPECT_EQ(code(level), ErrorCode::kInvalidArgument);
  level = sampled(26, 1.0, sphere_level);
  level.at(13, 12, 11) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(extract_isosurface(level).error().message,
            "level is nan at voxel (13, 12, 11), must be finite");
  level = sampled(26, 1.0, sphere_level);
  EXPECT_EQ(extract_isosurface(level, {.min_part_ml = -1.0}).error().code,
            ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace lefort::anatomy::test_extract_surface
