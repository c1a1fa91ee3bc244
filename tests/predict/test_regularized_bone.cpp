/// \file
/// Regularized bones below a block of tissue with nodes 2 mm apart:
///
///      | tissue|  z = 0 to 9
///      |_______|
///    |   bone    |
#include <lefort/geometry/mesh_properties.h>
#include <lefort/predict/predict_face.h>
#include <lefort/predict/regularized_bone.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <utility>

#include "support/paper_boundary.h"
#include "support/shapes.h"
#include "support/tissue_block.h"

namespace lefort::predict::test_regularized_bone {
namespace {

using test::kSide_mm;

constexpr double kH_mm = 2.0;
constexpr RegularizationOptions kOptions{.node_spacing_mm = kH_mm, .reach_mm = 4.5};

ContactBone contact_bone(const geometry::TriangleMesh& bone) {
  const double extent_mm = geometry::bounding_box(bone).sizes().maxCoeff();
  field::DistanceField field =
      field::build_distance_field(bone,
                                  {.resolution = 128, .band_mm = std::min(4.0, 0.2 * extent_mm)})
          .value();
  return {bone, std::make_shared<const field::DistanceField>(std::move(field))};
}

Result<RegularizedBone> regularized(const geometry::TriangleMesh& bone,
                                    const RegularizationOptions& options = kOptions,
                                    std::span<const AdjacentBone> adjacent = {}) {
  const FaceModel model = test::block_on_slab();
  const TissueAtRest tissue = tissue_at_rest(model.tissue, options).value();
  return regularize_bone(contact_bone(bone), adjacent, tissue, options);
}

/// Signed distance of a point to the surface.
double distance_mm(const geometry::TriangleMesh& surface, const Vec3& p_L) {
  return field::build_distance_field(surface, {.resolution = 128, .band_mm = 3.0})
      .value()
      .sample(p_L)
      .distance_mm;
}

geometry::TriangleMesh slab(double low_z, double high_z) {
  return test::make_box({-8.0, -8.0, low_z}, {20.0, 20.0, high_z});
}

/// Vertices under the tissue, away from its edges.
std::vector<Vec3> below_tissue(const geometry::TriangleMesh& surface) {
  std::vector<Vec3> found;
  for (const Vec3& v : surface.vertices)
    if (v.z() > -1.0 && (v.head<2>().array() > 4.5).all() &&
        (v.head<2>().array() < kSide_mm - 4.5).all())
      found.push_back(v);
  return found;
}

TEST(RegularizedBone, APlaneStays) {
  const RegularizedBone found = regularized(slab(-10.0, 0.0)).value();
  EXPECT_TRUE(geometry::is_closed(found.surface_L));
  const std::vector<Vec3> vertices = below_tissue(found.surface_L);
  ASSERT_GT(vertices.size(), 20U);
  for (const Vec3& v : vertices) EXPECT_NEAR(v.z(), 0.0, 0.02);
  EXPECT_LT(found.p50_distance_mm, 0.02);
}

TEST(RegularizedBone, TheTissueAtRestIsOutside) {
  const RegularizedBone found = regularized(slab(-10.0, 0.6)).value();  // 0.6 mm in the tissue.
  const std::vector<Vec3> vertices = below_tissue(found.surface_L);
  ASSERT_GT(vertices.size(), 20U);
  for (const Vec3& v : vertices) EXPECT_NEAR(v.z(), 0.0, 0.02);
}

TEST(RegularizedBone, AThinWallIsThickenedAwayFromTheTissue) {
  const RegularizedBone found = regularized(slab(-0.4, 0.0)).value();
  for (const Vec3& v : below_tissue(found.surface_L)) EXPECT_NEAR(v.z(), 0.0, 0.05 * kH_mm);
  EXPECT_LT(distance_mm(found.surface_L, {6.0, 6.0, -3.0}), 0.0);  // Behind the wall.
}

TEST(RegularizedBone, AGrooveNarrowerThanTheMeshIsClosed) {
  const geometry::TriangleMesh bone =
      test::join(test::make_box({-8.0, -8.0, -10.0}, {5.8, 20.0, 0.0}),
                 test::make_box({6.2, -8.0, -10.0}, {20.0, 20.0, 0.0}));
  const RegularizedBone found = regularized(bone).value();
  EXPECT_LT(distance_mm(found.surface_L, {6.0, 6.0, -1.0}), 0.0);
  EXPECT_LT(found.p99_distance_mm, 0.5 * kH_mm);
}

TEST(RegularizedBone, AnEdgeIsRounded) {
  // Beside an edge of 90 degrees below the tissue the normal turns over at least half of h.
  const RegularizedBone found =
      regularized(test::make_box({-8.0, -8.0, -10.0}, {6.0, 20.0, 0.0})).value();
  double highest_beside_mm = -10.0;
  for (const Vec3& v : found.surface_L.vertices)
    if (std::abs(v.x() - 6.0) < 0.1 && std::abs(v.y() - 6.0) < 3.0)
      highest_beside_mm = std::max(highest_beside_mm, v.z());
  EXPECT_LT(highest_beside_mm, -0.25 * kH_mm);
}

/// Lowest vertex of the left half of a bone below the tissue, if the right half moves as given.
double lowest_at_cut_mm(double separation_mm) {
  const ContactBone right = contact_bone(test::make_box({6.0, -8.0, -10.0}, {20.0, 20.0, 0.0}));
  const AdjacentBone adjacent[] = {{right.field_B, collar_mm(kH_mm, separation_mm)}};
  const RegularizedBone left =
      regularized(test::make_box({-8.0, -8.0, -10.0}, {6.0, 20.0, 0.0}), kOptions, adjacent)
          .value();
  EXPECT_TRUE(geometry::is_closed(left.surface_L));
  double lowest_mm = 0.0;
  for (const Vec3& v : below_tissue(left.surface_L))
    if (v.x() < 6.0) lowest_mm = std::min(lowest_mm, v.z());
  return lowest_mm;
}

TEST(RegularizedBone, ACutWhoseSidesStayTogetherIsNoGroove) {
  EXPECT_GT(lowest_at_cut_mm(0.0), -0.04 * kH_mm);
}

TEST(RegularizedBone, ACutWhoseSidesSeparateHasRoundEdges) {
  EXPECT_LT(lowest_at_cut_mm(kH_mm), -0.25 * kH_mm);
  EXPECT_LT(lowest_at_cut_mm(kH_mm), lowest_at_cut_mm(0.5 * kH_mm));
  EXPECT_LT(lowest_at_cut_mm(0.5 * kH_mm), lowest_at_cut_mm(0.0));
}

TEST(RegularizedBone, BoneBeyondTheReachIsLeftOut) {
  const RegularizationOptions near{.node_spacing_mm = kH_mm, .reach_mm = 3.0};
  const Box3 box = geometry::bounding_box(
      regularized(test::make_box({-50.0, -50.0, -40.0}, {60.0, 60.0, 0.0}), near)
          .value()
          .surface_L);
  EXPECT_GT(box.min().x(), -3.5);
  EXPECT_LT(box.max().y(), kSide_mm + 3.5);
  EXPECT_GT(box.min().z(), -3.5);
}

TEST(RegularizedBone, ABoneSmallerThanTheMeshHasNone) {
  const auto found = regularized(test::make_box({5.0, 5.0, -0.9}, {5.8, 5.8, -0.1}));
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::kMeshInvalid);
}

/// Contact begins when the bone has come closer, although the obstacle lies 0.7 mm below the bone.
TEST(RegularizedBone, TissueMovesWithTheBoneThatTheObstacleReplaces) {
  FaceModel model = test::block_on_slab();
  const geometry::RigidPath path = test::straight({0.0, 0.0, 1.0}, 2);
  const auto with_bone = predict_face(model, {path}, test::paper_options()).value();
  ContactBone low = test::moved(slab(-10.0, -0.7));
  model.segments[0].obstacle = std::make_shared<const ContactObstacle>(
      ContactObstacle{std::move(low.surface_B), std::move(low.field_B)});
  const auto with_obstacle = predict_face(model, {path}, test::paper_options()).value();
  ASSERT_TRUE(with_bone.converged() && with_obstacle.converged());
  for (std::size_t n = 0; n < model.tissue.nodes_L.size(); ++n)
    EXPECT_LT(
        (with_bone.steps.back().displacement_mm[n] - with_obstacle.steps.back().displacement_mm[n])
            .norm(),
        0.02);
}

}  // namespace
}  // namespace lefort::predict::test_regularized_bone
