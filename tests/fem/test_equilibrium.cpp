#include <lefort/core/parallel.h>
#include <lefort/fem/solve/equilibrium.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "fem/body.h"
#include "fem/random_deformation.h"
#include "support/box_mesh.h"

namespace lefort::fem::test_equilibrium {
namespace {

using mesh::ElementShape;
using test::affine;
using test::Body;
using test::box_mesh;
using test::BoxMeshOptions;
using test::joined;
using test::prescribe;
using test::prescribe_component;

constexpr NeoHookean kLaw{.mu_mpa = 0.5, .lambda_mpa = 2.0};

class Equilibrium : public testing::TestWithParam<ElementShape> {};
INSTANTIATE_TEST_SUITE_P(Shapes, Equilibrium, testing::ValuesIn(test::kAllElements),
                         test::shape_name);

/// \returns the sum of the forces on `nodes` in one component [N].
double reaction(const Body& body, const VectorX& u, const std::string& set, int component) {
  const VectorX residual_n = body.assembler.forces(u)->residual_n;
  double sum = 0.0;
  for (const auto node : body.mesh.node_sets.at(set))
    sum += residual_n[3 * Index(node) + component];
  return sum;
}

TEST_P(Equilibrium, PatchTestReproducesAnAffineDisplacement) {
  const auto mesh =
      box_mesh({.cells = {3, 4, 3}, .size_mm = {3, 4, 3}, .distortion = 0.19, .shape = GetParam()});
  Mat3 A;
  A << 0.10, 0.05, -0.02, 0.03, -0.08, 0.04, -0.06, 0.02, 0.12;
  const VectorX expected = affine(mesh, A, Vec3(0.1, -0.2, 0.3));
  for (const Material& law :
       {Material(kLaw), Material(LinearElastic{.mu_mpa = 0.5, .lambda_mpa = 2.0})}) {
    const Body body(mesh, {{0, law}}, prescribe(mesh.node_sets.at("outside"), expected));
    ASSERT_GT(body.assembler.dofs().free_count(), 0);
    const auto outcome = body.solve({.relative_tolerance = 1e-13});
    ASSERT_TRUE(outcome.converged()) << outcome.reason;
    EXPECT_LT((outcome.x - expected).lpNorm<Eigen::Infinity>(), 1e-12);
  }
}

/// Lateral stretch b and nominal stress P11 of a neo-Hookean bar of stretch a, sides free:
/// mu (b - 1/b) + lambda ln(a b^2) / b = 0, by bisection.
std::pair<double, double> uniaxial(const NeoHookean& law, double a) {
  double low = 0.1;
  double high = 3.0;
  for (int n = 0; n < 200; ++n) {
    const double b = 0.5 * (low + high);
    const double P22 = law.mu_mpa * (b - 1.0 / b) + law.lambda_mpa * std::log(a * b * b) / b;
    (P22 > 0.0 ? high : low) = b;
  }
  return {low, law.mu_mpa * (a - 1.0 / a) + law.lambda_mpa * std::log(a * low * low) / a};
}

/// A 2 x 1 x 1 mm bar on three symmetry planes; its end x1 is moved to stretch a.
Body bar(double a, const Material& law, ElementShape shape) {
  auto mesh =
      box_mesh({.cells = {4, 2, 2}, .size_mm = {2, 1, 1}, .distortion = 0.15, .shape = shape});
  auto conditions = joined({prescribe_component(mesh.node_sets.at("x0"), 0, 0.0),
                            prescribe_component(mesh.node_sets.at("y0"), 1, 0.0),
                            prescribe_component(mesh.node_sets.at("z0"), 2, 0.0),
                            prescribe_component(mesh.node_sets.at("x1"), 0, 2.0 * (a - 1.0))});
  return {std::move(mesh), {{0, law}}, std::move(conditions)};
}

TEST_P(Equilibrium, UniaxialStretchMatchesTheClosedForm) {
  for (const double a : {0.6, 1.5, 2.0}) {
    const Body body = bar(a, kLaw, GetParam());
    const auto outcome = body.solve({.relative_tolerance = 1e-13, .absolute_tolerance_n = 0.0});
    ASSERT_TRUE(outcome.converged()) << outcome.reason;
    const auto [b, P11_mpa] = uniaxial(kLaw, a);
    const VectorX expected =
        affine(body.mesh, Vec3(a - 1.0, b - 1.0, b - 1.0).asDiagonal(), Vec3::Zero());
    EXPECT_LT((outcome.x - expected).lpNorm<Eigen::Infinity>(), 1e-10);
    EXPECT_NEAR(reaction(body, outcome.x, "x1", 0), P11_mpa * 1.0, 1e-10);  // On 1 mm^2.
    EXPECT_NEAR(reaction(body, outcome.x, "x0", 0), -P11_mpa * 1.0, 1e-10);
  }
}

TEST_P(Equilibrium, AtSmallStrainTheBarFollowsHookesLaw) {
  const double young_mpa = 0.015;
  const double strain = -1e-6;
  const auto law = NeoHookean::from_young_poisson(young_mpa, 0.45).value();
  const Body body = bar(1.0 + strain, law, GetParam());
  const auto outcome = body.solve({.absolute_tolerance_n = 1e-16});
  ASSERT_TRUE(outcome.converged()) << outcome.reason;
  EXPECT_NEAR(reaction(body, outcome.x, "x1", 0), young_mpa * strain, 1e-5 * young_mpa * 1e-6);
}

TEST_P(Equilibrium, SimpleShearMatchesTheClosedForm) {
  const double gamma = 0.7;
  Mat3 A = Mat3::Zero();
  A(0, 1) = gamma;
  auto mesh = box_mesh({.cells = {3, 3, 3}, .distortion = 0.15, .shape = GetParam()});
  const VectorX expected = affine(mesh, A, Vec3::Zero());
  auto conditions = prescribe(mesh.node_sets.at("outside"), expected);
  const Body body(std::move(mesh), {{0, kLaw}}, std::move(conditions));
  const auto outcome = body.solve({.relative_tolerance = 1e-13});
  ASSERT_TRUE(outcome.converged()) << outcome.reason;
  EXPECT_NEAR(body.assembler.forces(outcome.x)->energy_mj, 0.5 * kLaw.mu_mpa * gamma * gamma,
              1e-12);
}

/// A block fixed at x0 whose end x1 is moved: bending, shear and a free surface.
Body bent_block(const RigidTransform& place, ElementShape shape = ElementShape::kTet4) {
  auto mesh =
      box_mesh({.cells = {5, 3, 3}, .size_mm = {10, 6, 6}, .distortion = 0.15, .shape = shape});
  for (Vec3& node : mesh.nodes_L) node = place * node;
  RigidTransform motion = RigidTransform::Identity();
  motion.translate(Vec3(1, 2, -1)).rotate(Eigen::AngleAxisd(0.4, Vec3(1, 1, 0).normalized()));
  const RigidTransform placed_motion = place * motion * place.inverse();
  auto conditions =
      joined({prescribe_zero(mesh.node_sets.at("x0")),
              prescribe_rigid_motion(mesh.node_sets.at("x1"), mesh.nodes_L, placed_motion)});
  return {std::move(mesh), {{0, kLaw}}, std::move(conditions)};
}

TEST(Equilibrium, RotatingTheWholeProblemRotatesTheResult) {
  test::RandomDeformation random(20);
  RigidTransform place = RigidTransform::Identity();
  place.translate(Vec3(30, -20, 10)).rotate(random.rotation());
  const Body here = bent_block(RigidTransform::Identity());
  const Body there = bent_block(place);
  const auto u_here = here.solve({.relative_tolerance = 1e-12});
  const auto u_there = there.solve({.relative_tolerance = 1e-12});
  ASSERT_TRUE(u_here.converged() && u_there.converged()) << u_there.reason;
  EXPECT_EQ(u_here.iterations(), u_there.iterations());
  for (Index n = 0; n < here.mesh.node_count(); ++n)
    EXPECT_LT((place.linear() * u_here.x.segment<3>(3 * n) - u_there.x.segment<3>(3 * n)).norm(),
              1e-9);
}

TEST(Equilibrium, NewtonConvergesQuadratically) {
  for (const ElementShape shape : {ElementShape::kTet4, ElementShape::kTet10}) {
    const auto outcome = bent_block(RigidTransform::Identity(), shape)
                             .solve({.relative_tolerance = 1e-11, .absolute_tolerance_n = 0.0});
    ASSERT_TRUE(outcome.converged()) << outcome.reason;
    // Observed order from the last three successive residuals above round-off.
    std::vector<double> r;
    for (const auto& line : outcome.history)
      if (line.residual_n > 1e-12 * line.residual_reference_n) r.push_back(line.residual_n);
    ASSERT_GE(r.size(), 3U);
    const std::size_t n = r.size() - 1;
    const double order = std::log(r[n] / r[n - 1]) / std::log(r[n - 1] / r[n - 2]);
    EXPECT_GT(order, 1.7);
    for (const auto& line : outcome.history) EXPECT_EQ(line.diagonal_shift, 0.0);
  }
}

TEST(Equilibrium, SameBitsForAnyNumberOfThreads) {
  const auto with_threads = [](int threads) {
    const ThreadLimit limit(threads);
    return bent_block(RigidTransform::Identity()).solve().x;
  };
  const VectorX one = with_threads(1);
  EXPECT_EQ(one, with_threads(2));
  EXPECT_EQ(one, with_threads(3));
}

TEST(Equilibrium, CantileverBendsLikeATimoshenkoBeam) {
  // Tip displacement d: force = d / (L^3 / (3 E I) + L / (5/6 G A)); clamped root, free rotation.
  const double L = 20.0;
  const double E = 1.0;
  const double tip_mm = 1e-3;
  auto mesh = box_mesh({.cells = {20, 2, 2}, .size_mm = {L, 2, 2}, .shape = ElementShape::kTet10});
  const auto conditions = joined({prescribe_zero(mesh.node_sets.at("x0")),
                                  prescribe_component(mesh.node_sets.at("x1"), 2, tip_mm)});
  const double inertia = 2.0 * 8.0 / 12.0;
  const double expected_n =
      tip_mm / (L * L * L / (3.0 * E * inertia) + L / (5.0 / 6.0 * E / 2.0 * 4.0));
  for (const Material& law : {Material(NeoHookean::from_young_poisson(E, 0.0).value()),
                              Material(LinearElastic::from_young_poisson(E, 0.0).value())}) {
    const Body body(mesh, {{0, law}}, conditions);
    const auto outcome = body.solve();
    ASSERT_TRUE(outcome.converged()) << outcome.reason;
    EXPECT_NEAR(reaction(body, outcome.x, "x1", 2), expected_n, 0.01 * expected_n);
  }
}

TEST(Equilibrium, TheLinearResponseAllowsABoundaryToMoveFurtherThanAnElement) {
  // The end moves by 3 mm into elements of 2 mm: with the boundary alone they would invert.
  auto mesh = box_mesh({.cells = {5, 2, 2}, .size_mm = {10, 4, 4}, .distortion = 0.1});
  auto conditions = joined({prescribe_zero(mesh.node_sets.at("x0")),
                            prescribe_component(mesh.node_sets.at("x1"), 0, -3.0)});
  const Body body(std::move(mesh), {{0, kLaw}}, std::move(conditions));
  const VectorX moved = body.assembler.dofs().with_prescribed(body.at_rest(), body.prescribed);
  ASSERT_FALSE(body.assembler.forces(moved).has_value());
  EXPECT_TRUE(body.solve().converged());
}

/// W = sqrt(1 + |x_b - x_a|^2): from far away Newton's step goes far beyond the minimum.
class FlatteningSpring final : public ForceTerm {
 public:
  Index item_count() const override { return 1; }
  std::span<const std::int32_t> nodes(Index) const override { return nodes_; }
  bool evaluate(Index, std::span<const Vec3> x_L, LocalEquations& local) const override {
    const Vec3 d = x_L[1] - x_L[0];
    const double W = std::sqrt(1.0 + d.squaredNorm());
    local.energy_mj = W;
    local.residual_n.head<3>() = -d / W;
    local.residual_n.tail<3>() = d / W;
    if (local.wants_stiffness()) {
      const Mat3 K = Mat3::Identity() / W - d * d.transpose() / (W * W * W);
      local.stiffness_n_per_mm << K, -K, -K, K;
    }
    return true;
  }

 private:
  std::array<std::int32_t, 2> nodes_{0, 1};
};

TEST(Equilibrium, ALinearResponseThatIncreasesTheEnergyIsNotUsed) {
  const FlatteningSpring spring;
  const std::vector<Vec3> nodes_L{Vec3::Zero(), Vec3(3, 0, 0)};
  const std::vector<PrescribedDisplacement> moved{
      {.node = 0, .component = 0, .displacement_mm = 0.1},
      {.node = 0, .component = 1},
      {.node = 0, .component = 2}};
  const Assembler assembler(nodes_L, DofMap::build(2, moved).value(), {&spring});
  linear::LinearSolver solver;
  // At the end the spring has no force: the residual reference is zero.
  const auto outcome =
      find_equilibrium(assembler, moved, VectorX::Zero(6), solver, {.absolute_tolerance_n = 1e-10});
  ASSERT_TRUE(outcome.converged()) << outcome.reason;
  EXPECT_NEAR(outcome.history[0].energy_mj, std::sqrt(1.0 + 2.9 * 2.9), 1e-14);
  EXPECT_NEAR(outcome.x[3], -2.9, 1e-8);
}

TEST(Equilibrium, ReportsThatTheBoundaryInvertsElements) {
  auto mesh = box_mesh({.cells = {2, 2, 2}});
  auto conditions = joined({prescribe_zero(mesh.node_sets.at("x0")),
                            prescribe_component(mesh.node_sets.at("x1"), 0, -1.5)});
  const Body body(std::move(mesh), {{0, kLaw}}, std::move(conditions));
  const auto outcome = body.solve();
  EXPECT_EQ(outcome.stop, NewtonStop::kInadmissibleStart);
  EXPECT_EQ(outcome.x.size(), 3 * body.mesh.node_count());
}

TEST(Equilibrium, AFreeBodyStaysWhereItIs) {
  const Body body(box_mesh(), {{0, kLaw}}, {});
  const auto outcome = body.solve();
  EXPECT_TRUE(outcome.converged());
  EXPECT_EQ(outcome.iterations(), 0);
}

TEST(Equilibrium, WithEverythingPrescribedThereIsNothingToSolve) {
  auto mesh = box_mesh({.cells = {1, 1, 1}});
  auto conditions =
      prescribe(mesh.node_sets.at("outside"), affine(mesh, 0.1 * Mat3::Identity(), Vec3::Zero()));
  const Body body(std::move(mesh), {{0, kLaw}}, std::move(conditions));
  const auto outcome = body.solve();
  EXPECT_TRUE(outcome.converged()) << outcome.reason;
  EXPECT_GT(reaction(body, outcome.x, "x1", 0), 0.0);
}

TEST(Equilibrium, ABucklingBlockConvergesPastItsIndefiniteTangent) {
  // A slender column compressed by a quarter: the straight state is not a minimum.
  auto mesh = box_mesh({.cells = {12, 2, 2}, .size_mm = {24, 2, 2}});
  for (Vec3& node : mesh.nodes_L) node.z() += 1e-3 * std::sin(std::numbers::pi * node.x() / 24.0);
  auto conditions = joined({prescribe_zero(mesh.node_sets.at("x0")),
                            prescribe_component(mesh.node_sets.at("x1"), 0, -6.0),
                            prescribe_component(mesh.node_sets.at("x1"), 1, 0.0),
                            prescribe_component(mesh.node_sets.at("x1"), 2, 0.0)});
  const Body body(std::move(mesh), {{0, kLaw}}, std::move(conditions));
  const auto outcome = body.solve({.max_iterations = 200});
  ASSERT_TRUE(outcome.converged()) << outcome.reason;
  double max_shift = 0.0;
  for (const auto& line : outcome.history) max_shift = std::max(max_shift, line.diagonal_shift);
  EXPECT_GT(max_shift, 0.0);
  linear::LinearSolver solver;  // The final state is stable: its tangent is positive definite.
  EXPECT_EQ(solver.factorize(body.assembler.tangent(outcome.x)), linear::LinearSolveStatus::kDone);
}

TEST(Equilibrium, EveryLinearSolverNeedsTheSameIterations) {
  auto mesh = box_mesh({.cells = {10, 10, 10}});
  auto conditions = joined({prescribe_zero(mesh.node_sets.at("x0")),
                            prescribe_component(mesh.node_sets.at("x1"), 0, -0.2),
                            prescribe_component(mesh.node_sets.at("x1"), 1, 0.1),
                            prescribe_component(mesh.node_sets.at("x1"), 2, 0.0)});
  const Body body(std::move(mesh), {{0, kLaw}}, std::move(conditions));
  const auto solved_by = [&](linear::LinearSolverKind kind) {
    linear::LinearSolver solver({.kind = kind});
    auto outcome = find_equilibrium(body.assembler, body.prescribed, body.at_rest(), solver);
    EXPECT_EQ(solver.kind(), kind);
    return outcome;
  };
  const auto direct = solved_by(linear::LinearSolverKind::kDirect);
  ASSERT_TRUE(direct.converged()) << direct.reason;
  for (const auto kind :
       {linear::LinearSolverKind::kReusedFactor, linear::LinearSolverKind::kMultigrid}) {
    const auto outcome = solved_by(kind);
    ASSERT_TRUE(outcome.converged()) << outcome.reason;
    EXPECT_LE(outcome.iterations(), direct.iterations() + 2);
    EXPECT_LT((outcome.x - direct.x).lpNorm<Eigen::Infinity>(), 1e-7);
  }
}

}  // namespace
}  // namespace lefort::fem::test_equilibrium
