#include <lefort/compare/register_segment.h>
#include <lefort/core/units.h>
#include <lefort/geometry/rigid_motion.h>
#include <lefort/geometry/transform_mesh.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "compare/blob.h"

namespace lefort::compare::test_register_segment {
namespace {

using geometry::rigid_motion;
using geometry::transformed;

const Vec3 kSkullRadii_mm(60.0, 80.0, 50.0), kSegmentRadii_mm(30.0, 25.0, 25.0);
const Vec3 kSegmentCenter(0.0, -85.0, -40.0);

TEST(RegisterSegment, DifferenceIsTranslationOfTheCenterAndRotation) {
  const geometry::TriangleMesh bone = test::make_box({-10, -10, -10}, {10, 10, 10});
  const RigidTransform first = rigid_motion({1, 0, 0}, Vec3::Zero(), Vec3::Zero());
  const RigidTransform second = rigid_motion({1, -2, 0}, {0, 0, 0.1}, Vec3::Zero());
  const MovementDifference difference = difference_of(first, second, bone);
  EXPECT_LT((difference.translation_mm - Vec3(0, -2, 0)).norm(), 1e-12);
  EXPECT_LT((difference.rotation_rad - Vec3(0, 0, 0.1)).norm(), 1e-12);
  // A corner lies sqrt(200) mm from the axis; its chord adds to the translation.
  EXPECT_GT(difference.max_mm, 2.0 + 0.9);
  EXPECT_LT(difference.max_mm, 2.0 + 1.5);
}

TEST(RegisterSegment, UnalteredRegionIsAwayFromSegments) {
  const auto part = unaltered_region(test::make_sheet(40.0, 40),
                                     std::array{test::make_box({-30, -30, -1}, {-10, 30, 1})}, 5.0);
  ASSERT_GT(part.triangle_count(), 0);
  double lowest = 40.0;
  for (const Vec3& v : part.vertices) lowest = std::min(lowest, v.x());
  EXPECT_NEAR(lowest, -5.0, 1.001);
  EXPECT_GT(lowest, -5.0);
}

/// End to end: two scans of one head in different frames, and a segment that is not at its planned
/// pose. Registered on the stationary bone, it is found within 0.1 mm and 0.1 degrees.
TEST(RegisterSegment, FindsTheAchievedAndNotThePlannedMovement) {
  const auto skull = test::make_blob(Vec3::Zero(), kSkullRadii_mm, 5);
  const auto segment = test::make_blob(kSegmentCenter, kSegmentRadii_mm, 4);
  const RigidTransform planned = rigid_motion({0, -6, 0}, Vec3::Zero(), kSegmentCenter);
  const RigidTransform achieved =
      rigid_motion({0.8, -7.1, -1.4}, {0.05, -0.02, 0.03}, kSegmentCenter);
  const RigidTransform other_scan = rigid_motion({20, -35, 12}, {0.2, -0.1, 0.25}, Vec3::Zero());
  const geometry::TriangleMesh after = transformed(
      test::joined(
          test::make_blob(Vec3::Zero(), kSkullRadii_mm, 5, test::some_twist()),
          transformed(test::make_blob(kSegmentCenter, kSegmentRadii_mm, 4, test::some_twist()),
                      achieved)),
      other_scan);

  const auto base = unaltered_region(skull, std::array{segment}, 10.0);
  const auto registered = register_surface(base, geometry::Bvh(after),
                                           initial_alignments(test::joined(skull, segment), after));
  ASSERT_TRUE(registered) << registered.error().message;
  const geometry::Bvh after_L(transformed(after, registered->X_onto_from.inverse()));
  const auto found = register_segment(segment, after_L, planned);
  ASSERT_TRUE(found) << found.error().message;
  const MovementDifference error = difference_of(achieved, found->X_onto_from, segment);
  EXPECT_LT(error.translation_mm.norm(), 0.1);
  EXPECT_LT(degrees_from_radians(error.rotation_rad.norm()), 0.1);
  EXPECT_LT(error.max_mm, 0.1);
}

}  // namespace
}  // namespace lefort::compare::test_register_segment
