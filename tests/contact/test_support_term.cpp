#include <lefort/contact/support_term.h>
#include <lefort/fem/assembly/assemble.h>
#include <lefort/fem/assembly/boundary_conditions.h>
#include <lefort/fem/assembly/dof_map.h>
#include <lefort/fem/assembly/element_term.h>
#include <lefort/fem/materials/neo_hookean.h>
#include <lefort/fem/solve/equilibrium.h>
#include <lefort/field/build/build_distance_field.h>
#include <lefort/linear/linear_solver.h>

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "support/box_mesh.h"
#include "support/shapes.h"

namespace lefort::contact::test_support_term {
namespace {

constexpr double kRadius_mm = 6.0, kNormal = 0.05, kTension = 0.01, kTangential = 0.02,
                 kArea_mm2 = 3.0;

/// A ball of bone.
RigidObstacle ball() {
  static const auto field = std::make_shared<const field::DistanceField>(
      field::build_distance_field(test::make_icosphere(kRadius_mm, 5),
                                  {.resolution = 64, .band_mm = 2.0, .smooth = true})
          .value());
  return {field_distance_query(field, DetectionMethod::kSmooth).value()};
}

const Vec3 kNormal_B = Vec3(1.0, 2.0, 2.0).normalized();
const Vec3 kOnBall_L = kRadius_mm * kNormal_B;  ///< A node at rest.

NodalSupport elevated() {
  return {.area_mm2 = kArea_mm2,
          .normal_B = kNormal_B,
          .normal_mpa_per_mm = kNormal,
          .tension_mpa_per_mm = kTension,
          .tangential_mpa_per_mm = kTangential};
}

NodalSupport sliding() {
  NodalSupport support = elevated();
  support.tension_mpa_per_mm = kNormal;
  support.tangential_mpa_per_mm = 0.0;
  support.follows_surface = true;
  return support;
}

NodalSupport separating() {
  NodalSupport support = sliding();
  support.tension_mpa_per_mm = 0.0;
  return support;
}

SupportTerm on_ball(const NodalSupport& support) {
  return SupportTerm(std::vector<Vec3>{kOnBall_L}, {support}, ball());
}

struct Evaluated {
  double energy_mj = 0.0;
  Vec3 residual_n = Vec3::Zero();
  Mat3 stiffness = Mat3::Zero();
};

Evaluated evaluate(const SupportTerm& term, const Vec3& x_L,
                   fem::Tangent tangent = fem::Tangent::kExact) {
  Evaluated result;
  VectorX residual_n = VectorX::Zero(3);
  Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(3, 3);
  fem::LocalEquations local{0.0, {residual_n.data(), 3}, {stiffness.data(), 3, 3}, tangent};
  EXPECT_TRUE(term.evaluate(0, std::vector<Vec3>{x_L}, local));
  result.energy_mj = local.energy_mj;
  result.residual_n = residual_n;
  result.stiffness = stiffness;
  return result;
}

RigidTransform some_motion() {
  RigidTransform X = RigidTransform::Identity();
  X.linear() = Eigen::AngleAxisd(0.3, Vec3(1.0, -1.0, 2.0).normalized()).toRotationMatrix();
  X.translation() = Vec3(2.0, -1.0, 0.5);
  return X;
}

/// Residual and stiffness are the derivatives of energy and residual, by central differences.
void expect_derivatives(const SupportTerm& term, const Vec3& x_L) {
  constexpr double kStep = 1e-5;
  const Evaluated at = evaluate(term, x_L);
  EXPECT_GT(at.residual_n.norm(), 1e-3);
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 step = kStep * Vec3::Unit(axis);
    const Evaluated above = evaluate(term, x_L + step), below = evaluate(term, x_L - step);
    EXPECT_NEAR(at.residual_n[axis], (above.energy_mj - below.energy_mj) / (2.0 * kStep), 1e-7);
    EXPECT_LT(
        (at.stiffness.col(axis) - (above.residual_n - below.residual_n) / (2.0 * kStep)).norm(),
        1e-5);
  }
}

TEST(SupportTerm, ForceAndStiffnessAreDerivativesOfTheEnergy) {
  const Vec3 offset_L(0.3, -0.4, 0.2);
  for (const NodalSupport& support : {elevated(), sliding(), separating()}) {
    SupportTerm term = on_ball(support);
    for (const RigidTransform& X_LB : {RigidTransform::Identity(), some_motion()}) {
      term.set_pose(X_LB);
      // In front of the bone and in it: a separating support acts only in it.
      if (support.tension_mpa_per_mm > 0.0) expect_derivatives(term, X_LB * kOnBall_L + offset_L);
      expect_derivatives(term, X_LB * (kOnBall_L - 0.7 * kNormal_B) + offset_L);
    }
  }
}

TEST(SupportTerm, OfElevatedTissueIsTheQuadraticFormOfTheHeader) {
  const SupportTerm term = on_ball(elevated());
  const Vec3 along = kNormal_B.unitOrthogonal();
  for (const auto& [e_mm, k_n] : {std::pair{0.4, kTension}, std::pair{-0.4, kNormal}}) {
    const Evaluated at = evaluate(term, kOnBall_L + e_mm * kNormal_B + 0.3 * along);
    EXPECT_NEAR(at.energy_mj, 0.5 * kArea_mm2 * (k_n * 0.16 + kTangential * 0.09), 1e-15);
    EXPECT_LT(
        (at.residual_n - kArea_mm2 * (k_n * e_mm * kNormal_B + kTangential * 0.3 * along)).norm(),
        1e-15);
  }
}

TEST(SupportTerm, SlidingTissueResistsOnlyItsDistanceFromTheBone) {
  const SupportTerm term = on_ball(sliding());
  // Around the ball at its surface: no force, though the node is 5 mm from where it was.
  const Vec3 aside = Eigen::AngleAxisd(0.8, kNormal_B.unitOrthogonal()) * kOnBall_L;
  EXPECT_GT((aside - kOnBall_L).norm(), 4.0);
  EXPECT_LT(evaluate(term, aside).residual_n.norm(), 1e-3 * kArea_mm2 * kNormal);
  // Away from the ball there: along the normal of the ball there, by the distance.
  const Evaluated off = evaluate(term, aside * (1.0 + 0.5 / kRadius_mm));
  const Vec3 wanted_n = kArea_mm2 * kNormal * 0.5 * aside.normalized();
  EXPECT_LT((off.residual_n - wanted_n).norm(), 0.01 * wanted_n.norm());
  EXPECT_GT(evaluate(on_ball(elevated()), aside).residual_n.norm(), 0.2 * kTangential * kArea_mm2);
}

TEST(SupportTerm, SeparatesWithoutTensionAndResistsCompression) {
  const SupportTerm held = on_ball(sliding()), loose = on_ball(separating());
  const Vec3 off_L = kOnBall_L + 0.5 * kNormal_B, in_L = kOnBall_L - 0.5 * kNormal_B;
  EXPECT_GT(evaluate(held, off_L).energy_mj, 0.0);
  EXPECT_EQ(evaluate(loose, off_L).energy_mj, 0.0);
  EXPECT_EQ(evaluate(loose, off_L).residual_n, Vec3::Zero());
  EXPECT_EQ(evaluate(loose, off_L).stiffness, Mat3::Zero());
  EXPECT_LT(evaluate(loose, in_L).residual_n.dot(kNormal_B), -0.4 * kArea_mm2 * kNormal);
  EXPECT_EQ(evaluate(loose, in_L).residual_n, evaluate(held, in_L).residual_n);
}

TEST(SupportTerm, ARigidMotionOfBoneAndTissueGivesNoForce) {
  for (const NodalSupport& support : {elevated(), sliding()}) {
    SupportTerm term = on_ball(support);
    term.set_pose(some_motion());
    const Evaluated together = evaluate(term, some_motion() * kOnBall_L);
    EXPECT_LT(together.energy_mj, 1e-20);
    EXPECT_LT(together.residual_n.norm(), 1e-12);
    EXPECT_GT(evaluate(term, kOnBall_L).residual_n.norm(), 1e-3);  // The bone alone.
  }
}

TEST(SupportTerm, AProjectedTangentHasNoNegativeEigenvalue) {
  const SupportTerm term = on_ball(sliding());
  // In the bone, the curvature of the ball times e < 0 is negative along the surface.
  const Vec3 in_L = kOnBall_L - 1.0 * kNormal_B;
  const Vec3 along = kNormal_B.unitOrthogonal();
  EXPECT_LT(along.dot(evaluate(term, in_L).stiffness * along), -1e-3);
  EXPECT_GE(along.dot(evaluate(term, in_L, fem::Tangent::kStabilized).stiffness * along), -1e-12);
}

TEST(SupportTerm, FollowsAFractionOfTheMotion) {
  NodalSupport support = elevated();
  support.motion_fraction = 0.25;
  SupportTerm term = on_ball(support);
  term.set_pose(some_motion());
  const Vec3 moved_mm = some_motion() * kOnBall_L - kOnBall_L;
  EXPECT_LT(evaluate(term, kOnBall_L + 0.25 * moved_mm).residual_n.norm(), 1e-14);
  // The normal keeps its direction.
  const Evaluated off = evaluate(term, kOnBall_L + 0.25 * moved_mm + 0.2 * kNormal_B);
  EXPECT_LT((off.residual_n - kArea_mm2 * kTension * 0.2 * kNormal_B).norm(), 1e-14);
  EXPECT_EQ(term.summarize(std::vector<Vec3>{kOnBall_L}).nodes, 0);
}

TEST(SupportTerm, StatisticsAreTheLargestSlipOpeningAndCompression) {
  const Vec3 along = kNormal_B.unitOrthogonal();
  const std::vector<Vec3> rest_L(3, kOnBall_L);
  std::vector<NodalSupport> supports(3, elevated());
  for (int n = 0; n < 3; ++n) supports[std::size_t(n)].node = n;
  const SupportTerm term(rest_L, supports, ball());
  const SupportStatistics all = term.summarize(std::vector<Vec3>{
      kOnBall_L + 0.3 * along, kOnBall_L + 0.2 * kNormal_B, kOnBall_L - 0.1 * kNormal_B});
  EXPECT_EQ(all.nodes, 3);
  EXPECT_NEAR(all.max_slip_mm, 0.3, 1e-12);
  EXPECT_NEAR(all.max_opening_mm, 0.2, 1e-12);
  EXPECT_NEAR(all.max_compression_mm, 0.1, 1e-12);
  const SupportStatistics rest = term.summarize(rest_L);
  EXPECT_EQ(rest.max_slip_mm + rest.max_opening_mm + rest.max_compression_mm, 0.0);
}

/// A column of tissue on a layer, its far end displaced by a prescribed amount, without lateral
/// strain: springs in series of stiffness M / L and k per area, where M is the uniaxial-strain
/// modulus for a motion along the column and mu for one across it.
TEST(SupportTerm, AColumnOnALayerIsTwoSpringsInSeries) {
  constexpr double kYoung = 0.015, kPoisson = 0.3, kLength_mm = 8.0, kSide_mm = 3.0;
  constexpr double kMu = kYoung / (2.0 * (1.0 + kPoisson));
  constexpr double kLambda = kYoung * kPoisson / ((1.0 + kPoisson) * (1.0 - 2.0 * kPoisson));
  const mesh::VolumeMesh column = test::box_mesh({.cells = {1, 1, 8},
                                                  .size_mm = {kSide_mm, kSide_mm, kLength_mm},
                                                  .shape = mesh::ElementShape::kHex8});
  const auto law = fem::NeoHookean::from_young_poisson(kYoung, kPoisson).value();
  const auto elements = fem::make_element_terms(column, {{0, law}}).value();
  struct Pull {
    int axis;
    double moved_mm, k;  // Small: the closed form is linear.
  };
  for (const auto& [axis, moved_mm, k] :
       {Pull{2, 1e-4, kTension}, Pull{2, -1e-4, kNormal}, Pull{0, 1e-4, kTangential}}) {
    const double modulus = axis == 2 ? kLambda + 2.0 * kMu : kMu;
    std::vector<NodalSupport> supports;
    for (const std::int32_t node : column.node_sets.at("z0"))
      supports.push_back({.node = node,
                          .area_mm2 = kSide_mm * kSide_mm / 4.0,
                          .normal_B = Vec3::UnitZ(),
                          .normal_mpa_per_mm = kNormal,
                          .tension_mpa_per_mm = kTension,
                          .tangential_mpa_per_mm = kTangential});
    const SupportTerm layer(column.nodes_L, supports, {});
    std::vector<fem::PrescribedDisplacement> prescribed;
    for (Index node = 0; node < column.node_count(); ++node) {
      const bool is_end = column.nodes_L[std::size_t(node)].z() > kLength_mm - 1e-9;
      for (int component = 0; component < 3; ++component)
        if (component != axis || is_end)
          prescribed.push_back(
              {std::int32_t(node), component, is_end && component == axis ? moved_mm : 0.0});
    }
    const fem::Assembler assembler(column.nodes_L,
                                   fem::DofMap::build(column.node_count(), prescribed).value(),
                                   {elements[0].get(), &layer});
    linear::LinearSolver solver;
    const fem::NewtonOutcome outcome =
        fem::find_equilibrium(assembler, prescribed, VectorX::Zero(3 * column.node_count()), solver,
                              {.relative_tolerance = 1e-10});
    ASSERT_TRUE(outcome.converged()) << outcome.reason;
    const double spring = modulus / kLength_mm;
    const double slip_mm = moved_mm * spring / (spring + k);
    for (const std::int32_t node : column.node_sets.at("z0"))
      EXPECT_NEAR(outcome.x[3 * node + axis], slip_mm, 1e-3 * std::abs(slip_mm)) << "axis " << axis;
  }
}

// The pseudonormal of a triangle mesh is no gradient: the line search must not use its energy.
TEST(SupportTerm, HasNoPotentialWhereItFollowsATriangleMesh) {
  const RigidObstacle triangles{bvh_distance_query(
      std::make_shared<const geometry::Bvh>(test::make_icosphere(kRadius_mm, 3)), 2.0)};
  const fem::DofMap dofs = fem::DofMap::build(1, {}).value();
  const std::vector<Vec3> nodes_L{kOnBall_L};
  EXPECT_TRUE(SupportTerm(nodes_L, {elevated()}, triangles).is_conservative(dofs));
  EXPECT_FALSE(SupportTerm(nodes_L, {elevated(), sliding()}, triangles).is_conservative(dofs));
  EXPECT_TRUE(on_ball(sliding()).is_conservative(dofs));
}

}  // namespace
}  // namespace lefort::contact::test_support_term
