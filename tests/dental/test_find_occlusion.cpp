#include <lefort/core/parallel.h>
#include <lefort/core/units.h>
#include <lefort/dental/find_occlusion.h>
#include <lefort/dental/gap_grid.h>
#include <lefort/geometry/rigid_motion.h>
#include <lefort/geometry/transform_mesh.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "dental/arch.h"

namespace lefort::dental {
namespace {

using geometry::Bvh;

const test::ArchShape kShape{.seed = 3.0};

/// Two arches that touch everywhere in occlusion: it is found from disturbed starts.
TEST(FindOcclusion, returns_to_the_known_occlusion) {
  const geometry::TriangleMesh upper_L = test::make_arch(kShape, true);
  const geometry::TriangleMesh lower_L = test::make_arch({.seed = 3.0, .step_mm = 0.4});
  const Vec3 center(0.0, 14.0, 4.0);
  for (int n = 0; n < 4; ++n) {
    const auto number = [&](double seed) { return 2.0 * test::some_number(seed, n) - 1.0; };
    // The last one is 5 mm away.
    const Vec3 shift = n == 3 ? Vec3(3.0, 3.5, -2.0)
                              : Vec3(3.0 * number(1.0), 4.0 * number(2.0), -2.0 + number(3.0));
    const Vec3 turn =
        radians_from_degrees(6.0) * Vec3(0.3 * number(4.0), 0.3 * number(5.0), number(6.0));
    const RigidTransform X = geometry::rigid_motion(shift, turn, center);
    const auto found = find_occlusion(upper_L, geometry::transformed(lower_L, X), {});
    ASSERT_TRUE(found) << found.error().message;
    const RigidTransform error = found->X_L_lower * X;
    EXPECT_LT((error * center - center).norm(), 0.15) << n;
    EXPECT_LT(geometry::rotation_vector(error.linear()).norm(), radians_from_degrees(0.3)) << n;
    EXPECT_LE(found->contacts.max_penetration_mm, kMaxOcclusalPenetration_mm + 1e-9);
    EXPECT_GT(found->contacts.left_mm2, 100.0);
    EXPECT_GT(found->contacts.right_mm2, 100.0);
  }
}

/// On the grid gaps are those of closest points, except for cusps smaller than its spacing.
TEST(FindOcclusion, gaps_on_the_grid_are_nearly_exact) {
  const geometry::TriangleMesh upper_L = test::make_arch(kShape, true);
  const geometry::TriangleMesh lower_L = test::make_arch(kShape);
  const Bvh surface(lower_L), upper(upper_L);
  const GapGrid grid(surface, lower_L.vertices);
  std::vector<double> errors_mm;
  for (Index v = 0; v < upper_L.vertex_count(); v += 7) {
    const Vec3 p = upper_L.vertices[std::size_t(v)] + Vec3(0.0, 0.0, 1.5);
    const Vec3 n = upper.pseudonormals().at_vertex(upper_L, v);
    const auto exact = gap_over(surface, p, n, GapGrid::kReach_mm);
    const auto fast = grid.gap_over(p, n);
    if (exact && fast) errors_mm.push_back(std::abs(exact->gap_mm - fast->gap_mm));
  }
  ASSERT_GT(errors_mm.size(), 100U);
  std::sort(errors_mm.begin(), errors_mm.end());
  EXPECT_LT(errors_mm[errors_mm.size() / 2], 0.05);
  EXPECT_LT(errors_mm[errors_mm.size() * 95 / 100], 0.3);
}

TEST(FindOcclusion, is_the_same_for_any_number_of_threads) {
  const geometry::TriangleMesh upper_L = test::make_arch(kShape, true);
  RigidTransform X = RigidTransform::Identity();
  X.translation() = Vec3(0.7, -0.4, -1.5);
  const geometry::TriangleMesh lower_L = geometry::transformed(test::make_arch(kShape), X);
  Eigen::Matrix4d poses[2];
  for (const int threads : {1, 3}) {
    const ThreadLimit limit(threads);
    const auto found = find_occlusion(upper_L, lower_L, {}, {.shift_mm = 0.0, .yaw_deg = 3.0});
    ASSERT_TRUE(found) << found.error().message;
    poses[threads == 1 ? 0 : 1] = found->X_L_lower.matrix();
  }
  EXPECT_EQ(poses[0], poses[1]);
}

TEST(FindOcclusion, measures_gaps_and_incisors) {
  const geometry::TriangleMesh upper_L = test::make_arch(kShape, true);
  const geometry::TriangleMesh lower_L = test::make_arch(kShape);
  RigidTransform X = RigidTransform::Identity();
  X.translation() = Vec3(0.0, 0.0, -1.0);
  const Occlusion open = measure_occlusion({Bvh(upper_L), Bvh(lower_L)}, X, {});
  EXPECT_EQ(open.contacts.left_mm2, 0.0);
  EXPECT_EQ(open.contacts.max_penetration_mm, 0.0);
  X.translation() = Vec3(0.0, 0.0, 0.3);
  const Occlusion deep = measure_occlusion({Bvh(upper_L), Bvh(lower_L)}, X, {});
  EXPECT_GT(deep.contacts.max_penetration_mm, 0.2);
  EXPECT_LT(deep.contacts.max_penetration_mm, 0.35);  // Both are triangulated differently.
}

/// The patient's left is +x. Only half of the upper arch is there.
TEST(FindOcclusion, separates_left_and_right) {
  const geometry::TriangleMesh lower_L = test::make_arch(kShape);
  geometry::TriangleMesh upper_L = test::make_arch(kShape, true);
  std::erase_if(upper_L.triangles, [&](const geometry::Triangle& triangle) {
    return upper_L.vertices[std::size_t(triangle[0])].x() < 0.0;
  });
  const Occlusion found =
      measure_occlusion({Bvh(upper_L), Bvh(lower_L)}, RigidTransform::Identity(), {});
  EXPECT_GT(found.contacts.left_mm2, 100.0);
  EXPECT_LT(found.contacts.right_mm2, 10.0);
}

/// Tooth opposite tooth, edge to edge at z = 6 mm or more.
TEST(FindOcclusion, measures_incisors) {
  const geometry::TriangleMesh lower_L = test::make_arch(kShape);
  geometry::TriangleMesh upper_L = lower_L;
  for (Vec3& p : upper_L.vertices) p.z() = 20.0 - p.z();
  for (geometry::Triangle& triangle : upper_L.triangles) std::swap(triangle[0], triangle[1]);
  RigidTransform X = RigidTransform::Identity();
  const Occlusion edge_to_edge = measure_occlusion({Bvh(upper_L), Bvh(lower_L)}, X, {});
  EXPECT_NEAR(edge_to_edge.overjet_mm, 0.0, 1e-9);
  EXPECT_LT(edge_to_edge.overbite_mm, -4.0);
  X.translation() = Vec3(1.0, 2.0, 5.0);  // The lower arch is 2 mm posterior, 5 mm up.
  const Occlusion moved = measure_occlusion({Bvh(upper_L), Bvh(lower_L)}, X, {});
  EXPECT_NEAR(moved.overjet_mm, 2.0, 1e-9);
  EXPECT_NEAR(moved.overbite_mm - edge_to_edge.overbite_mm, 5.0, 1e-9);
  X.translation() =
      Vec3(6.0, 0.0, 0.0);  // Another tooth is opposite, its edge is lower or as high.
  EXPECT_LE(measure_occlusion({Bvh(upper_L), Bvh(lower_L)}, X, {}).overbite_mm,
            edge_to_edge.overbite_mm + 1e-9);
  X.translation() = Vec3(70.0, 0.0, 0.0);  // Nothing is opposite.
  EXPECT_TRUE(std::isnan(measure_occlusion({Bvh(upper_L), Bvh(lower_L)}, X, {}).overjet_mm));
}

/// Where the upper arch ends, points of the lower one face nothing.
TEST(FindOcclusion, nothing_penetrates_beyond_the_border) {
  const geometry::TriangleMesh lower_L = test::make_arch(kShape);
  geometry::TriangleMesh upper_L = test::make_arch(kShape, true);
  std::erase_if(upper_L.triangles, [&](const geometry::Triangle& triangle) {
    return upper_L.vertices[std::size_t(triangle[0])].y() > 25.0;
  });
  RigidTransform X = RigidTransform::Identity();
  X.translation() = Vec3(0.0, 0.0, -0.5);
  EXPECT_EQ(measure_occlusion({Bvh(upper_L), Bvh(lower_L)}, X, {}).contacts.max_penetration_mm,
            0.0);
}

TEST(FindOcclusion, refuses_arches_that_do_not_face_each_other) {
  const geometry::TriangleMesh upper_L = test::make_arch(kShape, true);
  RigidTransform X = RigidTransform::Identity();
  X.translation() = Vec3(0.0, 0.0, -60.0);
  const auto far = find_occlusion(upper_L, geometry::transformed(test::make_arch(kShape), X), {});
  ASSERT_FALSE(far);
  EXPECT_EQ(far.error().code, ErrorCode::kNotConverged);
  EXPECT_FALSE(find_occlusion(upper_L, {}, {}));
  const auto swapped = find_occlusion(test::make_arch(kShape), upper_L, {});
  ASSERT_FALSE(swapped);
  EXPECT_NE(swapped.error().message.find("swapped"), std::string::npos);
  geometry::TriangleMesh huge = upper_L;
  huge.vertices[0] = Vec3(9e5, -9e5, 9e5);
  EXPECT_FALSE(find_occlusion(huge, test::make_arch(kShape), {}));
  EXPECT_FALSE(find_occlusion(upper_L, test::make_arch(kShape), {}, {.shift_mm = -1.0}));
}

}  // namespace
}  // namespace lefort::dental
