#include <lefort/contact/bone_points.h>
#include <lefort/contact/weighted_contact_term.h>
#include <lefort/field/build/build_distance_field.h>
#include <lefort/mesh/element_faces.h>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "support/shapes.h"

namespace lefort::contact::test_weighted_contact_term {
namespace {

constexpr double kStiffness = 0.04;

RigidObstacle obstacle(geometry::TriangleMesh surface) {
  auto field = std::make_shared<const field::DistanceField>(
      field::build_distance_field(surface, {.resolution = 64, .band_mm = 3.0, .smooth = true})
          .value());
  return {field_distance_query(field, DetectionMethod::kSmooth,
                               std::make_shared<const geometry::TriangleMesh>(std::move(surface)))
              .value()};
}

RigidObstacle ball() {
  static const RigidObstacle ball = obstacle(test::make_icosphere(6.0, 5));
  return ball;
}

RigidObstacle slab() {
  static const RigidObstacle slab = obstacle(test::make_box({-10, -10, -8}, {10, 10, 0}));
  return slab;
}

/// A box that stands on an edge along y; its uppermost edge is z = 0.
RigidObstacle make_ridge(double half_length_mm) {
  geometry::TriangleMesh box = test::make_box({-3, -half_length_mm, -3}, {3, half_length_mm, 3});
  const Eigen::AngleAxisd turn(0.25 * std::numbers::pi, Vec3::UnitY());
  for (Vec3& v : box.vertices) v = turn * v - Vec3(0.0, 0.0, 3.0 * std::numbers::sqrt2);
  return obstacle(std::move(box));
}

RigidObstacle ridge() {
  static const RigidObstacle ridge = make_ridge(8.0);
  return ridge;
}

struct Evaluated {
  bool is_admissible = true;
  double energy_mj = 0.0;
  VectorX residual_n;
  Eigen::MatrixXd stiffness;
};

/// Sum over all items.
Evaluated gather(const WeightedContactTerm& term, const std::vector<Vec3>& x_L,
                 fem::Tangent tangent = fem::Tangent::kExact) {
  const auto size = Index(3 * x_L.size());
  Evaluated sum{true, 0.0, VectorX::Zero(size), Eigen::MatrixXd::Zero(size, size)};
  for (Index item = 0; item < term.item_count(); ++item) {
    const auto nodes = term.nodes(item);
    std::vector<Vec3> local_L;
    for (const std::int32_t node : nodes) local_L.push_back(x_L[std::size_t(node)]);
    const auto count = Index(3 * nodes.size());
    VectorX r = VectorX::Zero(count);
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(count, count);
    fem::LocalEquations local{0.0, {r.data(), count}, {K.data(), count, count}, tangent};
    sum.is_admissible = sum.is_admissible && term.evaluate(item, local_L, local);
    sum.energy_mj += local.energy_mj;
    for (std::size_t a = 0; a < nodes.size(); ++a) {
      sum.residual_n.segment<3>(3 * nodes[a]) += r.segment<3>(3 * Index(a));
      for (std::size_t b = 0; b < nodes.size(); ++b)
        sum.stiffness.block<3, 3>(3 * nodes[a], 3 * nodes[b]) +=
            K.block<3, 3>(3 * Index(a), 3 * Index(b));
    }
  }
  return sum;
}

/// \param stiffness_error  allowed, as a fraction of the largest stiffness.
void expect_derivatives_of_energy(const WeightedContactTerm& term, const std::vector<Vec3>& x_L,
                                  double stiffness_error = 1e-4) {
  constexpr double kStep = 1e-6;
  const Evaluated at = gather(term, x_L);
  ASSERT_TRUE(at.is_admissible);
  const double scale = at.stiffness.cwiseAbs().maxCoeff();
  ASSERT_GT(scale, 0.0);
  EXPECT_LT((at.stiffness - at.stiffness.transpose()).norm(), 1e-12 * scale);
  for (Index dof = 0; dof < Index(3 * x_L.size()); ++dof) {
    std::vector<Vec3> plus = x_L, minus = x_L;
    plus[std::size_t(dof / 3)][dof % 3] += kStep;
    minus[std::size_t(dof / 3)][dof % 3] -= kStep;
    const Evaluated above = gather(term, plus), below = gather(term, minus);
    EXPECT_NEAR(at.residual_n[dof], (above.energy_mj - below.energy_mj) / (2.0 * kStep),
                1e-7 * scale);
    EXPECT_LT((at.stiffness.col(dof) - (above.residual_n - below.residual_n) / (2.0 * kStep))
                  .cwiseAbs()
                  .maxCoeff(),
              stiffness_error * scale)
        << dof;
  }
}

double min_eigenvalue(const Eigen::MatrixXd& A) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(A).eigenvalues().minCoeff();
}

/// Four linear or quadratic triangles around (0.1, -0.2) in the plane z = 0, or four
/// quadrilaterals; normals point down.
struct Patch {
  std::vector<Vec3> nodes_L;
  std::vector<mesh::Face> faces;
};

Patch patch_of(mesh::FaceShape shape) {
  const bool is_triangle = mesh::corner_count(shape) == 3;
  Patch patch;
  patch.nodes_L = {{0.1, -0.2, 0}, {2, 0.1, 0}, {0.2, 2.1, 0}, {-2, -0.1, 0}, {-0.1, -1.9, 0},
                   {2, 2, 0},      {-2, 2, 0},  {-2, -2, 0},   {2, -2, 0}};
  for (int n = 0; n < 4; ++n) {
    const std::int32_t next = 1 + (n + 1) % 4, here = 1 + n, corner = 5 + n;
    if (is_triangle)
      patch.faces.push_back({shape, {0, next, here}});
    else
      patch.faces.push_back({shape, {0, next, corner, here}});
  }
  if (is_triangle) patch.nodes_L.resize(5);
  if (mesh::node_count(shape) == mesh::corner_count(shape)) return patch;
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middles;
  const auto corners = std::size_t(mesh::corner_count(shape));
  for (mesh::Face& face : patch.faces)
    for (std::size_t a = 0; a < corners; ++a) {
      const std::int32_t from = face.nodes[a], to = face.nodes[(a + 1) % corners];
      const auto [at, is_new] =
          middles.try_emplace(std::minmax(from, to), std::int32_t(patch.nodes_L.size()));
      if (is_new)
        patch.nodes_L.push_back(
            0.5 * (patch.nodes_L[std::size_t(from)] + patch.nodes_L[std::size_t(to)]));
      face.nodes[corners + a] = at->second;
    }
  return patch;
}

class WeightedContactShapes : public testing::TestWithParam<mesh::FaceShape> {};
INSTANTIATE_TEST_SUITE_P(Shapes, WeightedContactShapes,
                         testing::Values(mesh::FaceShape::kTri3, mesh::FaceShape::kQuad4,
                                         mesh::FaceShape::kTri6, mesh::FaceShape::kQuad8));

TEST_P(WeightedContactShapes, WeightFunctionsSumToOneAndHavePositiveIntegrals) {
  std::array<double, kMaxFaceNodes> integral{};
  for (const WeightedPoint& point : weighted_quadrature(GetParam())) {
    double sum = 0.0;
    for (std::size_t a = 0; a < kMaxFaceNodes; ++a) {
      sum += point.M[a];
      integral[a] += point.at.weight * point.M[a];
    }
    EXPECT_NEAR(sum, 1.0, 1e-13);
  }
  for (int a = 0; a < mesh::node_count(GetParam()); ++a) EXPECT_GT(integral[std::size_t(a)], 0.01);
}

TEST(WeightedQuadrature, OnLinearFacesTheWeightFunctionsAreDualToTheShapeFunctions) {
  for (const mesh::FaceShape shape : {mesh::FaceShape::kTri3, mesh::FaceShape::kQuad4}) {
    const auto count = std::size_t(mesh::node_count(shape));
    for (std::size_t a = 0; a < count; ++a)
      for (std::size_t b = 0; b < count; ++b) {
        double product = 0.0, of_shape = 0.0;
        for (const WeightedPoint& point : weighted_quadrature(shape)) {
          product += point.at.weight * point.M[a] * point.at.N[b];
          of_shape += point.at.weight * point.at.N[b];
        }
        EXPECT_NEAR(product, a == b ? of_shape : 0.0, 1e-13);
      }
  }
}

TEST_P(WeightedContactShapes, ResidualAndStiffnessAreTheDerivativesOfTheEnergy) {
  const Patch patch = patch_of(GetParam());
  RigidObstacle below = ball();
  below.X_LB.translation() = Vec3(0.3, -0.2, -6.5);
  WeightedContactTerm term(patch.nodes_L, patch.faces, {below},
                           {.stiffness_mpa_per_mm = kStiffness});
  below.X_LB.translation().z() = -5.2;
  term.set_pose(0, below.X_LB);
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> shift_mm(-0.1, 0.1);
  for (int state = 0; state < 3; ++state) {
    std::vector<Vec3> x_L = patch.nodes_L;
    for (Vec3& x : x_L) x += Vec3(shift_mm(generator), shift_mm(generator), shift_mm(generator));
    expect_derivatives_of_energy(term, x_L);
    EXPECT_GT(min_eigenvalue(gather(term, x_L, fem::Tangent::kStabilized).stiffness), -1e-12);
  }
}

/// The ridge passes between the nodes: over faces, across their edges and through a vertex.
void expect_derivatives_at_ridge(mesh::FaceShape shape, RigidObstacle below, double depth_mm,
                                 double stiffness_error) {
  const Patch patch = patch_of(shape);
  below.X_LB.translation() = Vec3(0.45, 0.0, -0.5);
  WeightedContactTerm term(patch.nodes_L, patch.faces, {below},
                           {.stiffness_mpa_per_mm = kStiffness});
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> shift_mm(-0.6 * depth_mm, 0.6 * depth_mm);
  for (const double x_mm : {0.45, 0.9}) {
    below.X_LB.translation() = Vec3(x_mm, 0.013, depth_mm);
    term.set_pose(0, below.X_LB);
    std::vector<Vec3> x_L = patch.nodes_L;
    for (Vec3& x : x_L) x += Vec3(shift_mm(generator), shift_mm(generator), shift_mm(generator));
    expect_derivatives_of_energy(term, x_L, stiffness_error);
    EXPECT_GT(min_eigenvalue(gather(term, x_L, fem::Tangent::kStabilized).stiffness), -1e-10);
  }
}

TEST_P(WeightedContactShapes, SharpPointsHaveTheDerivativesOfTheEnergy) {
  expect_derivatives_at_ridge(GetParam(), make_ridge(0.5), 0.17, 1e-4);
}

/// The stiffness lacks the second derivatives of the fade, of second order in the depth.
TEST_P(WeightedContactShapes, SharpPointsNearTheBorderHaveTheForceOfTheEnergy) {
  expect_derivatives_at_ridge(GetParam(), ridge(), 0.02, 0.02);
}

TEST_P(WeightedContactShapes, UniformDepthOnAFlatBoneIsUniformPressure) {
  const Patch patch = patch_of(GetParam());
  WeightedContactTerm term(patch.nodes_L, patch.faces, {slab()},
                           {.stiffness_mpa_per_mm = kStiffness});
  RigidTransform X_LB = RigidTransform::Identity();
  X_LB.translation().z() = 0.5;
  term.set_pose(0, X_LB);
  double area_mm2 = 0.0;
  const NodePatches patches(patch.nodes_L, patch.faces);
  for (std::size_t n = 0; n < patches.point_count(); ++n) area_mm2 += patches.area_mm2(n);
  const Evaluated at = gather(term, patch.nodes_L);
  Vec3 force_n = Vec3::Zero();
  for (std::size_t n = 0; n < patch.nodes_L.size(); ++n)
    force_n -= at.residual_n.segment<3>(3 * Index(n));
  EXPECT_NEAR(force_n.z(), 2.0 * kStiffness * 0.5 * area_mm2, 1e-6);
  EXPECT_NEAR(at.energy_mj, kStiffness * 0.25 * area_mm2, 1e-6);
  const ContactStatistics sum = term.summarize(patch.nodes_L).front();
  EXPECT_NEAR(sum.force_L_n.z(), force_n.z(), 1e-9);
  EXPECT_NEAR(sum.max_penetration_increase_mm, 0.5, 1e-3);
  EXPECT_NEAR(sum.area_mm2, area_mm2, 1e-6);
  const std::vector<std::vector<NodalContact>> nodes = term.at_nodes_by_bone(patch.nodes_L);
  for (const NodalContact& node : nodes.front())
    EXPECT_NEAR(node.pressure_mpa, 2.0 * kStiffness * 0.5, 1e-6);
}

TEST(WeightedContactTerm, TissueAtRestIsFreeOfForceAlsoInsideSharpBone) {
  const Patch patch = patch_of(mesh::FaceShape::kTri3);
  RigidObstacle inside = ridge();
  inside.X_LB.translation() = Vec3(0.45, 0.0, 0.2);
  const WeightedContactTerm term(patch.nodes_L, patch.faces, {inside},
                                 {.stiffness_mpa_per_mm = kStiffness});
  EXPECT_GT(term.rest_penetration_mm(), 0.0);
  EXPECT_NEAR(gather(term, patch.nodes_L).energy_mj, 0.0, 1e-15);
}

TEST(WeightedContactTerm, NotingClearancesChangesNoResult) {
  const Patch patch = patch_of(mesh::FaceShape::kTri3);
  RigidObstacle below = ball();
  below.X_LB.translation() = Vec3(0.3, -0.2, -7.0);
  WeightedContactTerm plain(patch.nodes_L, patch.faces, {below},
                            {.stiffness_mpa_per_mm = kStiffness});
  WeightedContactTerm noted = plain;
  noted.note_clearances(patch.nodes_L);
  for (double z = -7.0; z < -5.0; z += 0.1) {
    RigidTransform X_LB = below.X_LB;
    X_LB.translation().z() = z;
    plain.set_pose(0, X_LB);
    noted.set_pose(0, X_LB);
    EXPECT_EQ(gather(plain, patch.nodes_L).residual_n, gather(noted, patch.nodes_L).residual_n)
        << z;
  }
}

TEST(WeightedContactTerm, NotingClearancesChangesNoResultOfSharpPoints) {
  const Patch patch = patch_of(mesh::FaceShape::kTri3);
  RigidObstacle below = ridge();
  below.X_LB.translation() = Vec3(0.45, 0.0, -0.5);
  WeightedContactTerm plain(patch.nodes_L, patch.faces, {below},
                            {.stiffness_mpa_per_mm = kStiffness});
  WeightedContactTerm noted = plain;
  noted.note_clearances(patch.nodes_L);
  double energy_mj = 0.0;
  for (double z = -0.5; z < 0.6; z += 0.1) {
    below.X_LB.translation().z() = z;
    plain.set_pose(0, below.X_LB);
    noted.set_pose(0, below.X_LB);
    EXPECT_EQ(gather(plain, patch.nodes_L).residual_n, gather(noted, patch.nodes_L).residual_n)
        << z;
    energy_mj += gather(plain, patch.nodes_L).energy_mj;
    EXPECT_EQ(plain.summarize(patch.nodes_L).front().force_L_n,
              noted.summarize(patch.nodes_L).front().force_L_n);
  }
  EXPECT_GT(energy_mj, 1e-3);
}

/// A tip that slides over the border of the faces loses its contact gradually.
TEST(WeightedContactTerm, TheForceOfASharpPointFadesOutTowardsTheBorder) {
  constexpr double kDepth_mm = 0.1, kStep_mm = 0.01;
  const Patch patch = patch_of(mesh::FaceShape::kTri3);
  geometry::TriangleMesh tip;
  tip.vertices = {{0, 0, 0}, {-1.8, -1.8, -6}, {1.8, -1.8, -6}, {0, 2.1, -6}};
  tip.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
  RigidObstacle below = obstacle(tip);
  below.X_LB.translation() = Vec3(0.3, 0.3, -0.5);
  WeightedContactTerm term(patch.nodes_L, patch.faces, {below},
                           {.stiffness_mpa_per_mm = kStiffness});
  double last_mj = 0.0, first_mj = 0.0, max_jump_mj = 0.0;
  for (int n = 0; n <= 140; ++n) {
    below.X_LB.translation() = Vec3(0.3 + kStep_mm * n, 0.3 + kStep_mm * n, kDepth_mm);
    term.set_pose(0, below.X_LB);
    const double energy_mj = gather(term, patch.nodes_L).energy_mj;
    if (n == 0)
      first_mj = energy_mj;
    else
      max_jump_mj = std::max(max_jump_mj, std::abs(energy_mj - last_mj));
    last_mj = energy_mj;
  }
  EXPECT_GT(first_mj, 0.0);
  EXPECT_EQ(last_mj, 0.0);
  EXPECT_LT(max_jump_mj, 0.15 * first_mj);
}

/// Bone in front of the other side of a thin layer of tissue is behind the faces of this side.
TEST(WeightedContactTerm, SharpBoneOnTheOtherSideOfTheTissueIsNoContact) {
  const Patch patch = patch_of(mesh::FaceShape::kTri3);
  for (const bool is_other_side : {false, true}) {
    RigidObstacle bone = ridge();
    bone.X_LB.translation() = Vec3(0.45, 0.0, -0.5);
    if (is_other_side)
      bone.X_LB.linear() = Eigen::AngleAxisd(std::numbers::pi, Vec3::UnitX()).matrix();
    WeightedContactTerm term(patch.nodes_L, patch.faces, {bone},
                             {.stiffness_mpa_per_mm = kStiffness});
    bone.X_LB.translation().z() = 0.2;
    term.set_pose(0, bone.X_LB);
    std::vector<Vec3> lifted = patch.nodes_L;  // The weighted gaps are open.
    const double energy_mj = gather(term, lifted).energy_mj;
    if (is_other_side)
      EXPECT_EQ(energy_mj, 0.0);
    else
      EXPECT_GT(energy_mj, 0.0);
  }
}

TEST(WeightedContactTerm, TheAreaOfAFaceCountsWithItsActiveNodesOnly) {
  const Patch patch = patch_of(mesh::FaceShape::kTri3);
  RigidObstacle below = slab();
  below.X_LB.translation().z() = -3.0;
  WeightedContactTerm term(patch.nodes_L, patch.faces, {below},
                           {.stiffness_mpa_per_mm = kStiffness});
  below.X_LB.translation().z() = 0.0;
  term.set_pose(0, below.X_LB);
  std::vector<Vec3> x_L = patch.nodes_L;
  for (Vec3& x : x_L) x.z() = 0.8;
  x_L[0].z() = -0.2;  // The node in the middle of all faces.
  double area_mm2 = 0.0;
  const NodePatches patches(patch.nodes_L, patch.faces);
  for (std::size_t n = 0; n < patches.point_count(); ++n) area_mm2 += patches.area_mm2(n);
  EXPECT_NEAR(term.summarize(x_L).front().area_mm2, area_mm2 / 3.0, 1e-9);
}

TEST(WeightedContactTerm, CarriedNodesAllowAMotionThatWouldPassThroughThem) {
  const Patch patch = patch_of(mesh::FaceShape::kTri3);
  RigidObstacle plate = obstacle(test::make_box({-10, -10, -0.6}, {10, 10, 0}));
  plate.X_LB.translation().z() = -0.2;
  WeightedContactTerm term(patch.nodes_L, patch.faces, {plate},
                           {.stiffness_mpa_per_mm = kStiffness});
  const std::vector<RigidTransform> from{plate.X_LB};
  plate.X_LB.translation().z() = 3.0;
  term.set_pose(0, plate.X_LB);
  EXPECT_LT(term.max_motion(patch.nodes_L, from, patch.nodes_L), 1.0);
  const std::vector<Vec3> moved_with_bones =
      term.moved_with_bones(patch.nodes_L, from, patch.nodes_L);
  EXPECT_EQ(term.max_motion(patch.nodes_L, from, moved_with_bones), 1.0);
  for (std::size_t n = 0; n < moved_with_bones.size(); ++n)
    EXPECT_NEAR(moved_with_bones[n].z() - patch.nodes_L[n].z(), 3.2, 1e-12);
}

TEST(WeightedContactTerm, TwoBonesActAsOneObstacle) {
  const Patch patch = patch_of(mesh::FaceShape::kTri3);
  RigidObstacle one = slab(), other = slab();
  one.X_LB.translation() = Vec3(0, 0, 0.5);
  other.X_LB.translation() = Vec3(0, 0, 0.5);
  RigidObstacle start = slab();
  start.X_LB.translation().z() = -1.0;
  WeightedContactTerm alone(patch.nodes_L, patch.faces, {start},
                            {.stiffness_mpa_per_mm = kStiffness});
  WeightedContactTerm both(patch.nodes_L, patch.faces, {start, start},
                           {.stiffness_mpa_per_mm = kStiffness});
  alone.set_pose(0, one.X_LB);
  both.set_pose(0, one.X_LB);
  both.set_pose(1, other.X_LB);
  EXPECT_EQ(gather(alone, patch.nodes_L).residual_n, gather(both, patch.nodes_L).residual_n);
}

TEST(BonePoints, FindsTheEdgesOfABoxAndNoPointOfABall) {
  const RigidObstacle box = slab(), round = ball();
  const BonePoints edges =
      sharp_points(*box.distance_query_B->surface_B(), *box.distance_query_B, 2.0);
  EXPECT_GT(edges.points_B().size(), 12u * 8u * 5u / 2u);
  for (const Vec3& p : edges.points_B()) {
    // Within half an element of an edge; near a corner also beside the edges.
    const int near_sides = int(10 - std::abs(p.x()) < 1.0) + int(10 - std::abs(p.y()) < 1.0) +
                           int(-p.z() < 1.0 || p.z() + 8 < 1.0);
    EXPECT_GE(near_sides, 2) << p.transpose();
  }
  EXPECT_TRUE(sharp_points(*round.distance_query_B->surface_B(), *round.distance_query_B, 2.0)
                  .points_B()
                  .empty());
}

TEST(BonePoints, ListsThePointsOfABox) {
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> coordinate(-3.0, 7.0);
  std::vector<Vec3> points;
  std::vector<BonePoint> with_normals;
  for (int n = 0; n < 400; ++n) {
    points.emplace_back(coordinate(generator), coordinate(generator), coordinate(generator));
    with_normals.push_back({points.back(), points.back().normalized()});
  }
  const BonePoints all(with_normals, 0.1);
  for (std::size_t n = 0; n < all.size(); ++n)
    EXPECT_EQ(all.normals_B()[n], all.points_B()[n].normalized());
  const Box3 box(Vec3(-1, 0, 2), Vec3(3, 8, 5));
  std::size_t found = 0, expected = 0;
  all.for_each_in(box, [&](std::size_t n) {
    EXPECT_TRUE(box.contains(all.points_B()[n]));
    ++found;
  });
  for (const Vec3& p : points) expected += box.contains(p) ? 1 : 0;
  EXPECT_EQ(found, expected);
  EXPECT_GT(found, 10u);
}

}  // namespace
}  // namespace lefort::contact::test_weighted_contact_term
