/// \file
/// The symmetry plane of surfaces with a known plane.
#include <lefort/geometry/rigid_motion.h>
#include <lefort/geometry/symmetry_plane.h>
#include <lefort/geometry/transform_mesh.h>

#include <gtest/gtest.h>

#include <cmath>

#include "support/shapes.h"

namespace lefort::geometry::test_symmetry_plane {
namespace {

/// A body that is symmetric about x = 0 only, 150 x 190 x 220 mm.
TriangleMesh head() {
  TriangleMesh mesh = test::make_icosphere(1.0, 5);
  for (Vec3& v : mesh.vertices) {
    const double nose = 25.0 * std::exp(-40.0 * (v - Vec3(0, -1, 0)).squaredNorm());
    const double chin = 15.0 * std::exp(-10.0 * (v - Vec3(0, -0.7, -0.7)).squaredNorm());
    v = v.cwiseProduct(Vec3(75, 95, 110)) + Vec3(0, -nose - chin, -chin);
  }
  return mesh;
}

double degrees_between(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180.0 / std::numbers::pi;
}

TEST(SymmetryPlane, OfATurnedBodyIsFound) {
  for (const Vec3& turn : {Vec3(0.1, 0.12, -0.1), Vec3(-0.2, -0.1, 0.14), Vec3(0, 0, 0)}) {
    const RigidTransform X = rigid_motion({7, -3, 12}, turn, Vec3::Zero());
    const TriangleMesh mesh = transformed(head(), X);
    const SymmetryPlane plane =
        fit_symmetry_plane(Bvh(mesh), mesh.vertices, {Vec3::Zero(), Vec3::UnitX()});
    EXPECT_LT(degrees_between(plane.normal, X.linear().col(0)), 0.05);
    EXPECT_NEAR(plane.normal.dot(plane.point - X.translation()), 0.0, 0.05);
    EXPECT_LT(plane.rms_mm, 0.3);
  }
}

TEST(SymmetryPlane, IgnoresALumpOnOneSide) {
  TriangleMesh mesh = head();
  for (Vec3& v : mesh.vertices)
    v.x() += 30.0 * std::exp(-(v - Vec3(70, -20, 0)).squaredNorm() / 400.0);
  const SymmetryPlane plane = fit_symmetry_plane(Bvh(mesh), mesh.vertices,
                                                 {Vec3(3, 0, 0), Vec3(1, 0.05, 0.05).normalized()});
  EXPECT_LT(degrees_between(plane.normal, Vec3::UnitX()), 0.3);
  EXPECT_NEAR(plane.normal.dot(plane.point), 0.0, 0.3);
  EXPECT_LT(plane.inlier_fraction, 0.99);
}

}  // namespace
}  // namespace lefort::geometry::test_symmetry_plane
