#include <lefort/geometry/mesh_properties.h>
#include <lefort/mesh/cut_surface.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "support/shapes.h"

namespace lefort::mesh::test_cut_surface {
namespace {

using geometry::signed_volume_mm3;
using geometry::TriangleMesh;

/// Both parts are closed, and their volumes add up to the whole.
void expect_sound(const Result<SurfaceCut>& cut, const TriangleMesh& whole) {
  ASSERT_TRUE(cut) << cut.error().message;
  const double whole_mm3 = signed_volume_mm3(whole);
  EXPECT_TRUE(cut->inside.triangles.empty() || geometry::is_closed(cut->inside));
  EXPECT_TRUE(cut->outside.triangles.empty() || geometry::is_closed(cut->outside));
  EXPECT_NEAR(cut->whole_volume_mm3, whole_mm3, 1e-9 * whole_mm3);
  EXPECT_NEAR(cut->inside_volume_mm3 + cut->outside_volume_mm3, whole_mm3, 1e-6 * whole_mm3);
  EXPECT_EQ(cut->inside_volume_mm3, signed_volume_mm3(cut->inside));
  EXPECT_EQ(cut->outside_volume_mm3, signed_volume_mm3(cut->outside));
  EXPECT_EQ(cut->plane_shift_mm, 0.0);
}

TEST(CutSurface, SplitsABoxIntoExactVolumes) {
  const TriangleMesh box = test::make_box({0, 0, 0}, {4, 5, 6});
  const std::array half_spaces{HalfSpace{{1, 0, 0}, {-2, 0, 0}}, HalfSpace{{0, 0, 2}, {0, 0, 1}}};
  const auto cut = cut_surface(box, half_spaces);
  expect_sound(cut, box);
  EXPECT_NEAR(cut->inside_volume_mm3, 1.0 * 5.0 * 4.0, 1e-12);
  EXPECT_NEAR(cut->outside_volume_mm3, 100.0, 1e-12);
}

TEST(CutSurface, CapsLieInThePlanesAndTheRestOnTheCorrectSide) {
  const TriangleMesh sphere = test::make_icosphere(10.0, 4);
  const std::array half_spaces{HalfSpace{{0, 2, 0}, {0.1, -1, 0.2}},
                               HalfSpace{{0, 0, 3}, {0, 0.3, -1}}};
  const auto cut = cut_surface(sphere, half_spaces);
  expect_sound(cut, sphere);
  double cap_area_mm2 = 0.0;
  for (Index t = 0; t < cut->inside.triangle_count(); ++t) {
    for (const HalfSpace& half : half_spaces) {
      const auto height = [&](int corner) {
        return half.normal.normalized().dot(cut->inside.corner(t, corner) - half.point);
      };
      EXPECT_GT(height(0), -1e-12);
      if (std::max({height(0), height(1), height(2)}) > 1e-12) continue;
      const Vec3& a = cut->inside.corner(t, 0);
      const Vec3 twice_area = (cut->inside.corner(t, 1) - a).cross(cut->inside.corner(t, 2) - a);
      EXPECT_LE(twice_area.dot(half.normal), 1e-12);  // Caps face out of the half-space.
      cap_area_mm2 += 0.5 * twice_area.norm();
    }
  }
  // The cut adds each cap to both parts.
  const double added_mm2 = geometry::area_mm2(cut->inside) + geometry::area_mm2(cut->outside) -
                           geometry::area_mm2(sphere);
  EXPECT_GT(cap_area_mm2, 100.0);
  EXPECT_NEAR(added_mm2, 2.0 * cap_area_mm2, 1e-9 * cap_area_mm2);
}

TEST(CutSurface, SphericalCapHasTheTheoreticalVolume) {
  const TriangleMesh sphere = test::make_icosphere(10.0, 5);
  const std::array half_spaces{HalfSpace{{0, 0, 6}, {0, 0, 1}}};
  const auto cut = cut_surface(sphere, half_spaces);
  expect_sound(cut, sphere);
  const double height = 4.0;
  const double expected = std::numbers::pi * height * height * (30.0 - height) / 3.0;
  EXPECT_NEAR(cut->inside_volume_mm3, expected, 0.003 * expected);  // The sphere is a polyhedron.
}

TEST(CutSurface, PlaneThroughItsAxisSplitsATorusIntoTwoBodies) {
  const TriangleMesh torus = test::make_torus(10.0, 3.0, 48, 24);
  const std::array half_spaces{HalfSpace{{0, 0, 0}, {0, 1, 0}}, HalfSpace{{4, 0, 0}, {1, 0, 0}}};
  const auto cut = cut_surface(torus, half_spaces);
  expect_sound(cut, torus);
  EXPECT_EQ(geometry::connected_components(cut->inside).count, 1);
  const std::array half{HalfSpace{{0, 0.1, 0}, {0, 1, 0}}};
  const auto halves = cut_surface(torus, half);
  expect_sound(halves, torus);
  EXPECT_EQ(geometry::euler_characteristic(halves->inside), 2);  // Half a torus is a ball.
}

TEST(CutSurface, CavitiesArePreserved) {
  TriangleMesh ball = test::join(test::make_icosphere(10.0, 3),
                                 test::turn_inside_out(test::make_icosphere(4.0, 3)));
  ball = test::join(ball, test::turn_inside_out(test::make_icosphere(1.0, 2, {0, 0, 7})));
  ball = test::join(ball, test::make_icosphere(2.0, 2));  // A separate body in the large cavity.
  const std::array half_spaces{HalfSpace{{0, 0, 0.5}, {0.05, 0, 1}}};
  const auto cut = cut_surface(ball, half_spaces);
  expect_sound(cut, ball);
  EXPECT_EQ(geometry::connected_components(cut->inside).count, 3);   // Shell, small cavity, body.
  EXPECT_EQ(geometry::connected_components(cut->outside).count, 2);  // Shell, body.
}

TEST(CutSurface, CutsThroughVerticesAndAlongFaces) {
  const TriangleMesh box = test::make_box({-1, -1, -1}, {1, 1, 1});
  for (const HalfSpace& half : {HalfSpace{{0, 0, 0}, {1, 1, 0}}, HalfSpace{{0, 0, 0}, {1, 1, 1}},
                                HalfSpace{{0, 0, 0}, {1, -1, 0}}}) {
    const auto cut = cut_surface(box, std::array{half});
    expect_sound(cut, box);
    EXPECT_NEAR(cut->inside_volume_mm3, 4.0, 1e-12);
  }
  const auto all = cut_surface(box, std::array{HalfSpace{{0, 0, -1}, {0, 0, 1}}});
  ASSERT_TRUE(all) << all.error().message;
  EXPECT_NEAR(all->inside_volume_mm3, 8.0, 1e-3);
}

TEST(CutSurface, PartIsEmptyIfThePlanesMiss) {
  const TriangleMesh sphere = test::make_icosphere(10.0, 2);
  const auto missed = cut_surface(sphere, std::array{HalfSpace{{0, 0, 11}, {0, 0, 1}}});
  expect_sound(missed, sphere);
  EXPECT_TRUE(missed->inside.triangles.empty());
  const auto all = cut_surface(sphere, std::array{HalfSpace{{0, 0, -11}, {0, 0, 1}}});
  expect_sound(all, sphere);
  EXPECT_TRUE(all->outside.triangles.empty());
  const std::array far{HalfSpace{{0, 0, 1e5}, {0, 0, 1}}};
  expect_sound(cut_surface(sphere, far), sphere);
}

TEST(CutSurface, ManyPlanesCutAConvexCavity) {
  const TriangleMesh sphere = test::make_icosphere(10.0, 3);
  std::vector<HalfSpace> half_spaces;
  for (int i = 0; i < 12; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 12;
    const Vec3 outward(std::cos(angle), std::sin(angle), 0.0);
    half_spaces.push_back({5.0 * outward, -outward});
  }
  half_spaces.push_back({{0, 0, -2}, {0, 0, 1}});
  half_spaces.push_back({{0, 0, 2}, {0, 0, -1}});
  const auto cut = cut_surface(sphere, half_spaces);
  expect_sound(cut, sphere);
  const double prism_mm3 = 12.0 * 25.0 * std::tan(std::numbers::pi / 12.0) * 4.0;
  EXPECT_NEAR(cut->inside_volume_mm3, prism_mm3, 1e-9);  // Inside the sphere: a cavity.
  EXPECT_EQ(geometry::connected_components(cut->outside).count, 2);
}

TEST(CutSurface, ResultDoesNotDependOnTheFrame) {
  RigidTransform X = RigidTransform::Identity();
  X.linear() = Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  X.translation() = Vec3(120, -80, 900);
  const TriangleMesh torus = test::make_torus(10.0, 3.0, 48, 24);
  const HalfSpace half{{1, 0, 0}, {1, 0.2, 0.1}};
  const auto here = cut_surface(torus, std::array{half});
  const auto there = cut_surface(test::moved(torus, X),
                                 std::array{HalfSpace{X * half.point, X.linear() * half.normal}});
  ASSERT_TRUE(here && there);
  EXPECT_NEAR(here->inside_volume_mm3, there->inside_volume_mm3, 1e-8);
}

TEST(CutSurface, AllowsSelfIntersectionsAwayFromTheCut) {
  const TriangleMesh crossing =
      test::join(test::make_icosphere(5.0, 3), test::make_icosphere(5.0, 3, {0, 0, 6}));
  const auto cut = cut_surface(crossing, std::array{HalfSpace{{0, 0, -1}, {0, 0.1, -1}}});
  expect_sound(cut, crossing);
}

void expect_error(const Result<SurfaceCut>& cut, ErrorCode code, const std::string& words) {
  ASSERT_FALSE(cut);
  EXPECT_EQ(cut.error().code, code);
  EXPECT_NE(cut.error().message.find(words), std::string::npos) << cut.error().message;
}

TEST(CutSurface, RejectsASurfaceThatCrossesItselfAlongTheCut) {
  const TriangleMesh crossing =
      test::join(test::make_icosphere(5.0, 3), test::make_icosphere(5.0, 3, {0, 0, 6}));
  expect_error(cut_surface(crossing, std::array{HalfSpace{{0, 0, 0}, {0, 1, 0}}}),
               ErrorCode::kMeshingFailed, "crosses itself along the cut");
}

TEST(CutSurface, RejectsAnOpenSurface) {
  const std::array half_spaces{HalfSpace{{0, 0, 0}, {0, 0, 1}}};
  expect_error(cut_surface(test::make_sheet(4.0, 3), half_spaces), ErrorCode::kMeshInvalid, "open");
  expect_error(cut_surface({}, half_spaces), ErrorCode::kMeshInvalid, "");
}

TEST(CutSurface, RejectsInvalidHalfSpaces) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const TriangleMesh box = test::make_box({0, 0, 0}, {1, 1, 1});
  expect_error(cut_surface(box, std::span<const HalfSpace>()), ErrorCode::kInvalidArgument,
               "no half-space");
  expect_error(cut_surface(box, std::array{HalfSpace{{0, 0, 0}, {0, 0, 0}}}),
               ErrorCode::kInvalidArgument, "half-space 0");
  expect_error(cut_surface(box, std::array{HalfSpace{{0, kNan, 0}, {0, 0, 1}}}),
               ErrorCode::kInvalidArgument, "half-space 0");
}

class StopAtOnce : public Progress {
  [[nodiscard]] bool stop_requested() const override { return true; }
};

TEST(CutSurface, StopsOnRequest) {
  StopAtOnce stop;
  expect_error(cut_surface(test::make_box({0, 0, 0}, {1, 1, 1}),
                           std::array{HalfSpace{{0, 0, 0.5}, {0, 0, 1}}}, stop),
               ErrorCode::kCancelled, "cancelled");
}

TEST(CutSurface, SameInputSameBits) {
  const TriangleMesh torus = test::make_torus(10.0, 3.0, 48, 24);
  const std::array half_spaces{HalfSpace{{1, 0, 0}, {1, 0.2, 0.1}}};
  const auto once = cut_surface(torus, half_spaces);
  const auto again = cut_surface(torus, half_spaces);
  EXPECT_EQ(once->inside.vertices, again->inside.vertices);
  EXPECT_EQ(once->inside.triangles, again->inside.triangles);
  EXPECT_EQ(once->outside.triangles, again->outside.triangles);
}

}  // namespace
}  // namespace lefort::mesh::test_cut_surface
