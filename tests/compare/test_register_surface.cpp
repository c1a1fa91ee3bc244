#include <lefort/compare/register_surface.h>
#include <lefort/core/parallel.h>
#include <lefort/core/units.h>
#include <lefort/geometry/mesh_properties.h>
#include <lefort/geometry/rigid_motion.h>
#include <lefort/geometry/transform_mesh.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "compare/blob.h"

namespace lefort::compare::test_register_surface {
namespace {

using geometry::rigid_motion;
using geometry::transformed;

const Vec3 kRadii_mm(60.0, 80.0, 50.0);
const std::array<RigidTransform, 1> kAsItIs{RigidTransform::Identity()};

/// Largest distance between the positions of a vertex after two motions.
double max_miss_mm(const RigidTransform& a, const RigidTransform& b,
                   const geometry::TriangleMesh& mesh) {
  double max_residual_mm = 0.0;
  for (const Vec3& v : mesh.vertices)
    max_residual_mm = std::max(max_residual_mm, (a * v - b * v).norm());
  return max_residual_mm;
}

TEST(RegisterSurface, FindsAKnownMotionOnAnotherTriangulation) {
  const auto from = test::make_blob(Vec3::Zero(), kRadii_mm, 5);
  const RigidTransform X = rigid_motion({4.0, -3.0, 6.0}, {0.1, -0.15, 0.08}, {10, 0, 0});
  const geometry::Bvh onto(
      transformed(test::make_blob(Vec3::Zero(), kRadii_mm, 5, test::some_twist()), X));
  const auto found = register_surface(from, onto, kAsItIs);
  ASSERT_TRUE(found) << found.error().message;
  // Chords of 2.5 mm on radii of 60 mm lie 0.01 mm below the body.
  EXPECT_LT(max_miss_mm(found->X_onto_from, X, from), 0.02);
  EXPECT_LT(found->rms_mm, 0.02);
  EXPECT_GT(found->inlier_fraction, 0.5);
}

TEST(RegisterSurface, FindsReversedHeads) {
  const auto from = test::make_blob(Vec3::Zero(), kRadii_mm, 4);
  for (const Vec3& turn : {Vec3(0.0, 0.0, 2.8), Vec3(1.4, 0.3, 0.0), Vec3(0.2, -3.0, 0.1)}) {
    const RigidTransform X = rigid_motion({300.0, -150.0, 80.0}, turn, Vec3::Zero());
    const auto there =
        transformed(test::make_blob(Vec3::Zero(), kRadii_mm, 4, test::some_twist()), X);
    const auto found =
        register_surface(from, geometry::Bvh(there), initial_alignments(from, there));
    ASSERT_TRUE(found) << found.error().message;
    EXPECT_LT(max_miss_mm(found->X_onto_from, X, from), 0.1) << turn.transpose();
  }
}

/// A third of the body is displaced: it must not influence the registration of the rest.
TEST(RegisterSurface, IgnoresAPartThatMoved) {
  const auto still = test::make_blob(Vec3::Zero(), kRadii_mm, 5);
  const auto segment = test::make_blob({0, -85, -40}, {30, 25, 25}, 4);
  const auto before = test::joined(still, segment);
  const auto after = test::joined(
      still, transformed(segment, rigid_motion({0, -8, -3}, {0.1, 0, 0}, Vec3::Zero())));
  const RigidTransform X = rigid_motion({5, 2, -4}, {0.05, 0.02, -0.1}, Vec3::Zero());
  const auto found = register_surface(before, geometry::Bvh(transformed(after, X)), kAsItIs);
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_LT(max_miss_mm(found->X_onto_from, X, before), 0.02);
}

TEST(RegisterSurface, ReportsSurfacesThatDoNotFit) {
  const auto from = test::make_blob(Vec3::Zero(), kRadii_mm, 3);
  const geometry::Bvh elsewhere(test::make_box({-500, -500, -500}, {500, 500, -490}));
  const auto found = register_surface(from, elsewhere, kAsItIs);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::kNotConverged) << found.error().message;
}

/// A bone of about the same size to which the iterations converge, but not the same one.
TEST(RegisterSurface, RejectsAnotherBody) {
  const auto from = test::make_blob(Vec3::Zero(), kRadii_mm, 4);
  const geometry::Bvh other(test::make_box({-52, -70, -44}, {55, 66, 47}));
  const auto found = register_surface(from, other, initial_alignments(from, other.mesh()));
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::kNotConverged);
  EXPECT_NE(found.error().message.find("do both show the same bone"), std::string::npos)
      << found.error().message;
}

TEST(RegisterSurface, RejectsASphereThatCanRotateInItself) {
  const geometry::Bvh onto(test::make_icosphere(50.0, 5));
  const auto found = register_surface(test::make_icosphere(50.0, 4, {1, 2, 3}), onto, kAsItIs);
  ASSERT_FALSE(found);
  EXPECT_NE(found.error().message.find("slide"), std::string::npos) << found.error().message;
}

TEST(RegisterSurface, RejectsTooFewPoints) {
  const geometry::Bvh onto(test::make_box({0, 0, 0}, {1, 1, 1}));
  EXPECT_EQ(register_surface(onto.mesh(), onto, kAsItIs).error().code, ErrorCode::kInvalidArgument);
  const auto blob = test::make_blob(Vec3::Zero(), kRadii_mm, 3);
  EXPECT_EQ(register_surface(blob, onto, {}).error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(register_surface(blob, onto, kAsItIs, {.max_points = 99}).error().code,
            ErrorCode::kInvalidArgument);
  EXPECT_EQ(register_surface(blob, onto, kAsItIs, {.max_iterations = 0}).error().code,
            ErrorCode::kInvalidArgument);
  EXPECT_EQ(register_surface(blob, onto, kAsItIs, {.max_median_mm = 0.0}).error().code,
            ErrorCode::kInvalidArgument);
}

TEST(RegisterSurface, CanBeStopped) {
  struct Stop : Progress {
    bool stop_requested() const override { return true; }
  } stop;
  const auto blob = test::make_blob(Vec3::Zero(), kRadii_mm, 3);
  const auto found = register_surface(blob, geometry::Bvh(blob), kAsItIs, {}, stop);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::kCancelled);
}

TEST(RegisterSurface, SameBitsForAnyNumberOfThreads) {
  const auto from = test::make_blob(Vec3::Zero(), kRadii_mm, 4);
  const geometry::Bvh onto(transformed(from, rigid_motion({1, 2, 3}, {0.1, 0, 0}, Vec3::Zero())));
  const auto with = [&](int threads) {
    const ThreadLimit limit(threads);
    return register_surface(from, onto, kAsItIs).value().X_onto_from.matrix().eval();
  };
  EXPECT_EQ(with(1), with(2));
}

}  // namespace
}  // namespace lefort::compare::test_register_surface
