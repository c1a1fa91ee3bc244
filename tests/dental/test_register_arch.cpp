#include <lefort/core/units.h>
#include <lefort/dental/register_arch.h>
#include <lefort/geometry/rigid_motion.h>
#include <lefort/geometry/transform_mesh.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>

#include "dental/arch.h"

namespace lefort::dental {
namespace {

/// Crowns of a lower arch. The occlusal direction of an upper one is to inferior.
Crowns crowns_of(const test::ArchShape& shape, anatomy::Tooth jaw) {
  Crowns crowns;
  crowns.jaw = jaw;
  crowns.surface_L = test::make_arch(shape);
  for (const Vec3& p : crowns.surface_L.vertices)
    crowns.center_L += p / double(crowns.surface_L.vertices.size());
  crowns.occlusal_L = Vec3::UnitZ();
  crowns.anterior_L = -Vec3::UnitY();
  return crowns;
}

const test::ArchShape kLower{.seed = 1.0};
const test::ArchShape kUpper{.half_width_mm = 30.0, .length_mm = 46.0, .seed = 2.0};

/// The intraoral scan of an arch: another triangulation, with gingiva, in another frame.
geometry::TriangleMesh scan_of(test::ArchShape shape, const RigidTransform& X) {
  shape.step_mm = 0.37;
  shape.skirt_mm = 4.0;
  return geometry::transformed(test::make_arch(shape), X);
}

geometry::TriangleMesh without_molars_of_a_side(geometry::TriangleMesh scan_L,
                                                const Crowns& crowns) {
  std::erase_if(scan_L.triangles, [&](const geometry::Triangle& triangle) {
    return std::any_of(triangle.begin(), triangle.end(), [&](std::int32_t v) {
      const Vec3 arm = scan_L.vertices[std::size_t(v)] - crowns.center_L;
      return arm.x() > 0.0 && arm.dot(crowns.anterior_L) < 0.0;
    });
  });
  return scan_L;
}

/// The mirror image; its triangles face outward.
geometry::TriangleMesh mirror_image(geometry::TriangleMesh scan) {
  for (Vec3& p : scan.vertices) p.x() = -p.x();
  for (geometry::Triangle& triangle : scan.triangles) std::swap(triangle[0], triangle[1]);
  return scan;
}

TEST(RegisterArch, finds_scans_from_any_frame) {
  const Crowns crowns = crowns_of(kLower, anatomy::Tooth::kLower);
  for (int n = 0; n < 3; ++n) {
    const Vec3 turn(6.0 * test::some_number(7.0, n) - 3.0, 6.0 * test::some_number(8.0, n) - 3.0,
                    6.0 * test::some_number(9.0, n) - 3.0);
    const RigidTransform X = geometry::rigid_motion({100.0, -40.0 * n, 7.0}, turn, Vec3::Zero());
    const auto found = register_arch(scan_of(kLower, X), crowns, nullptr);
    ASSERT_TRUE(found) << n << ": " << found.error().message;
    const RigidTransform error = found->X_L_scan * X;
    EXPECT_LT((error * crowns.center_L - crowns.center_L).norm(), 0.05) << n;
    EXPECT_LT(geometry::rotation_vector(error.linear()).norm(), radians_from_degrees(0.2)) << n;
    EXPECT_LT(found->all.rms_mm, 0.1);
    EXPECT_GT(found->all.fraction, 0.8);
    EXPECT_NEAR(found->scale, 1.0, 0.003);
    EXPECT_FALSE(found->is_reversed);
  }
}

TEST(RegisterArch, finds_a_scan_without_the_molars_of_a_side) {
  const Crowns crowns = crowns_of(kLower, anatomy::Tooth::kLower);
  const RigidTransform X = geometry::rigid_motion({5.0, 9.0, 2.0}, {0.4, 1.0, -0.3}, Vec3::Zero());
  const geometry::TriangleMesh scan =
      without_molars_of_a_side(scan_of(kLower, RigidTransform::Identity()), crowns);
  const auto found = register_arch(geometry::transformed(scan, X), crowns, nullptr);
  ASSERT_TRUE(found) << found.error().message;
  const RigidTransform error = found->X_L_scan * X;
  EXPECT_LT((error * crowns.center_L - crowns.center_L).norm(), 0.05);
  EXPECT_LT(geometry::rotation_vector(error.linear()).norm(), radians_from_degrees(0.2));
  EXPECT_LT(found->all.rms_mm, 0.1);
}

TEST(RegisterArch, turns_triangles_that_face_inward) {
  const Crowns crowns = crowns_of(kLower, anatomy::Tooth::kLower);
  geometry::TriangleMesh scan = scan_of(kLower, RigidTransform::Identity());
  for (geometry::Triangle& triangle : scan.triangles) std::swap(triangle[0], triangle[1]);
  const auto found = register_arch(scan, crowns, nullptr);
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_TRUE(found->is_reversed);
  EXPECT_LT(found->all.rms_mm, 0.1);
}

void expect_refused(const geometry::TriangleMesh& scan, const std::string& reason) {
  const Crowns lower = crowns_of(kLower, anatomy::Tooth::kLower);
  const Crowns upper = crowns_of(kUpper, anatomy::Tooth::kUpper);
  const auto found = register_arch(scan, lower, &upper);
  ASSERT_FALSE(found) << reason;
  EXPECT_NE(found.error().message.find(reason), std::string::npos) << found.error().message;
}

TEST(RegisterArch, refuses_what_is_not_a_scan_of_this_jaw) {
  const RigidTransform X = geometry::rigid_motion({5.0, 9.0, 2.0}, {0.4, 1.0, -0.3}, Vec3::Zero());
  expect_refused(scan_of(kUpper, X), "swapped");
  geometry::TriangleMesh scan = scan_of(kLower, X);
  expect_refused(mirror_image(scan), "mirror");
  const geometry::TriangleMesh part = without_molars_of_a_side(
      scan_of(kLower, RigidTransform::Identity()), crowns_of(kLower, anatomy::Tooth::kLower));
  expect_refused(mirror_image(geometry::transformed(part, X)), "mirror");
  for (Vec3& p : scan.vertices) p *= 1.03;
  expect_refused(scan, "scaled");
  for (Vec3& p : scan.vertices) p *= 0.001;
  expect_refused(scan, "meters");
  expect_refused({}, "no triangle");
}

}  // namespace
}  // namespace lefort::dental
