#include <lefort/fem/faces/all_faces.h>
#include <lefort/fem/loads/follower_pressure.h>
#include <lefort/mesh/element_faces.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "fem/body.h"
#include "fem/random_deformation.h"
#include "support/box_mesh.h"

namespace lefort::fem::test_follower_pressure {
namespace {

using mesh::ElementShape;
using test::box_mesh;

constexpr NeoHookean kLaw{.mu_mpa = 0.5, .lambda_mpa = 2.0};

std::unique_ptr<FollowerPressure> pressure_on(const mesh::VolumeMesh& mesh, const std::string& set,
                                              double pressure_mpa) {
  auto term = FollowerPressure::build(mesh.nodes_L, mesh.face_sets.at(set)).value();
  term->set_pressure_mpa(pressure_mpa);
  return term;
}

Assembler assembler_of(const mesh::VolumeMesh& mesh, const FollowerPressure& term,
                       const std::vector<PrescribedDisplacement>& prescribed = {}) {
  return {mesh.nodes_L, DofMap::build(mesh.node_count(), prescribed).value(), {&term}};
}

/// \returns random displacements of all nodes up to the given size.
VectorX shaken(const mesh::VolumeMesh& mesh, double max_displacement_mm, unsigned seed) {
  test::RandomDeformation random(seed);
  return VectorX::NullaryExpr(3 * mesh.node_count(),
                              [&] { return max_displacement_mm * random.number(); });
}

Vec3 resultant(const VectorX& residual_n) {
  return residual_n.reshaped(3, residual_n.size() / 3).rowwise().sum();
}

class Pressures : public testing::TestWithParam<ElementShape> {};
INSTANTIATE_TEST_SUITE_P(Shapes, Pressures, testing::ValuesIn(test::kAllElements),
                         test::shape_name);

TEST_P(Pressures, OnAClosedSurfaceForceAndTangentAreDerivativesOfTheEnergy) {
  const auto mesh = box_mesh({.cells = {2, 1, 1}, .size_mm = {3, 2, 2}, .shape = GetParam()});
  const auto term = pressure_on(mesh, "boundary", 0.7);
  const Assembler assembler = assembler_of(mesh, *term);
  ASSERT_TRUE(term->is_conservative(assembler.dofs()));
  const VectorX u = shaken(mesh, 0.2, 1);
  const VectorX residual = assembler.forces(u)->residual_n;
  const Eigen::MatrixXd lower = assembler.tangent(u);
  const double h = 1e-4;
  for (Index k = 0; k < u.size(); ++k) {
    VectorX step = VectorX::Zero(u.size());
    step[k] = h;
    const auto plus = assembler.forces(u + step);
    const auto minus = assembler.forces(u - step);
    EXPECT_EQ(plus->follower_n.size(), 0);
    EXPECT_NEAR(residual[k], (plus->energy_mj - minus->energy_mj) / (2 * h), 1e-8);
    const VectorX column = (plus->residual_n - minus->residual_n) / (2 * h);
    EXPECT_LT((lower.col(k) - column).tail(u.size() - k).norm(), 1e-9);
  }
}

TEST_P(Pressures, OnAClosedSurfaceTheEnergyIsPressureTimesVolumeAndForcesCancel) {
  const auto mesh = box_mesh({.cells = {2, 2, 1}, .size_mm = {3, 2, 2}, .shape = GetParam()});
  const auto term = pressure_on(mesh, "boundary", 0.7);
  const Assembler assembler = assembler_of(mesh, *term);
  test::RandomDeformation random(2);
  const Mat3 F = random.gradient();
  const auto affine = assembler.forces(test::affine(mesh, F - Mat3::Identity(), Vec3(10, 20, -30)));
  EXPECT_NEAR(affine->energy_mj, 0.7 * 12.0 * (F.determinant() - 1.0), 1e-11);
  EXPECT_LT(resultant(assembler.forces(shaken(mesh, 0.3, 3))->residual_n).norm(), 1e-12);
}

TEST_P(Pressures, PressesOnTheCurrentAreaAlongTheCurrentNormal) {
  const auto mesh = box_mesh({.cells = {2, 3, 2}, .size_mm = {3, 2, 4}, .shape = GetParam()});
  const auto term = pressure_on(mesh, "z1", 0.7);
  test::RandomDeformation random(4);
  const Mat3 F = random.gradient();
  const auto forces =
      assembler_of(mesh, *term).forces(test::affine(mesh, F - Mat3::Identity(), Vec3(1, 2, 3)));
  // Nanson: n da = cof F N dA. The residual is minus the force on the body.
  EXPECT_LT((resultant(forces->residual_n) - 0.7 * 6.0 * cofactor(F).col(2)).norm(), 1e-12);
}

TEST_P(Pressures, OnABulgingPatchTheForceIsThatOnThePlaneWithinItsBorder) {
  // The total force on a closed surface is zero: the area vectors of any bulge add up to that of
  // the plane within its border.
  const auto mesh = box_mesh({.cells = {3, 3, 1}, .size_mm = {3, 2, 1}, .shape = GetParam()});
  const auto term = pressure_on(mesh, "z1", -0.4);
  VectorX u = VectorX::Zero(3 * mesh.node_count());
  for (Index n = 0; n < mesh.node_count(); ++n) {
    const Vec3& X = mesh.nodes_L[std::size_t(n)];
    u[3 * n + 2] = X.x() * (3.0 - X.x()) * X.y() * (2.0 - X.y());
  }
  const Vec3 residual = resultant(assembler_of(mesh, *term).forces(u)->residual_n);
  EXPECT_LT((residual - Vec3(0, 0, -0.4 * 6.0)).norm(), 1e-12);
}

TEST_P(Pressures, IsConservativeIfTheBorderIsPrescribed) {
  const auto mesh = box_mesh({.cells = {2, 2, 1}, .shape = GetParam()});
  const auto term = pressure_on(mesh, "z1", 1.0);
  std::vector<std::int32_t> border;
  for (const std::int32_t node : mesh.node_sets.at("z1")) {
    const Vec3& X = mesh.nodes_L[std::size_t(node)];
    if (X.x() == 0.0 || X.x() == 1.0 || X.y() == 0.0 || X.y() == 1.0) border.push_back(node);
  }
  const auto dofs_with = [&](const std::vector<PrescribedDisplacement>& prescribed) {
    return DofMap::build(mesh.node_count(), prescribed).value();
  };
  EXPECT_TRUE(term->is_conservative(dofs_with(prescribe_zero(border))));
  EXPECT_FALSE(term->is_conservative(dofs_with({})));
  EXPECT_FALSE(term->is_conservative(dofs_with(test::prescribe_component(border, 2, 0.0))));
  border.pop_back();
  EXPECT_FALSE(term->is_conservative(dofs_with(prescribe_zero(border))));
}

TEST_P(Pressures, WithAPrescribedBorderForcesAreDerivativesOfTheEnergy) {
  auto mesh = box_mesh({.cells = {2, 2, 1}, .shape = GetParam()});
  const auto term = pressure_on(mesh, "z1", 0.7);
  auto fixed_nodes = mesh.node_sets.at("x0");
  for (const char* set : {"x1", "y0", "y1"})
    fixed_nodes.insert(fixed_nodes.end(), mesh.node_sets.at(set).begin(),
                       mesh.node_sets.at(set).end());
  const Assembler assembler = assembler_of(mesh, *term, prescribe_zero(fixed_nodes));
  const VectorX u = shaken(mesh, 0.1, 5);  // The border is displaced, too.
  const VectorX free = assembler.dofs().free_part(assembler.forces(u)->residual_n);
  ASSERT_GT(free.norm(), 0.01);
  const double h = 1e-4;
  for (Index k = 0; k < free.size(); ++k) {
    const VectorX step =
        assembler.dofs().with_free_part(VectorX::Zero(u.size()), VectorX::Unit(free.size(), k) * h);
    const double slope =
        (assembler.forces(u + step)->energy_mj - assembler.forces(u - step)->energy_mj) / (2 * h);
    EXPECT_NEAR(free[k], slope, 1e-9);
  }
}

TEST_P(Pressures, ABlockUnderUniformPressureShrinksUniformly) {
  const auto mesh = box_mesh({.cells = {2, 2, 2}, .distortion = 0.15, .shape = GetParam()});
  const double p = 0.8;
  // Three symmetry planes.
  const auto prescribed =
      test::joined({test::prescribe_component(mesh.node_sets.at("x0"), 0, 0.0),
                    test::prescribe_component(mesh.node_sets.at("y0"), 1, 0.0),
                    test::prescribe_component(mesh.node_sets.at("z0"), 2, 0.0)});
  // F = l I: mu (l - 1/l) + 3 lambda ln(l) / l = -p l^2, by bisection.
  double low = 0.5;
  double high = 1.0;
  for (int n = 0; n < 100; ++n) {
    const double l = 0.5 * (low + high);
    const double P = kLaw.mu_mpa * (l - 1.0 / l) + 3.0 * kLaw.lambda_mpa * std::log(l) / l;
    (P + p * l * l > 0.0 ? high : low) = l;
  }
  const VectorX expected = test::affine(mesh, (low - 1.0) * Mat3::Identity(), Vec3::Zero());
  // On all sides, or on the other three sides only: the border then slides in the planes, where the
  // tangent is exact, too.
  std::vector<mesh::Face> three_sides;
  for (const char* set : {"x1", "y1", "z1"}) {
    const auto& side = mesh.face_sets.at(set);
    three_sides.insert(three_sides.end(), side.begin(), side.end());
  }
  for (const auto& faces : {mesh.face_sets.at("boundary"), three_sides}) {
    const auto term = FollowerPressure::build(mesh.nodes_L, faces).value();
    term->set_pressure_mpa(p);
    const test::Body body(mesh, {{0, kLaw}}, prescribed, {term.get()});
    const auto outcome = body.solve({.relative_tolerance = 1e-12});
    ASSERT_TRUE(outcome.converged()) << outcome.reason;
    EXPECT_LE(outcome.iterations(), 7);
    EXPECT_LT((outcome.x - expected).lpNorm<Eigen::Infinity>(), 1e-10);
  }
}

/// \returns the sum of the area vectors of a surface of tri6 or quad8, from its border: half of the
///   line integral of x (x) dx over straight or quadratic edges, given by ends and mid-edge nodes.
Vec3 border_area(const std::vector<std::array<Vec3, 3>>& edges) {
  Vec3 sum = Vec3::Zero();
  for (const auto& [begin, middle, end] : edges)
    for (const auto& [s, weight] :
         {std::pair{-std::sqrt(0.6), 5.0 / 9.0}, {0.0, 8.0 / 9.0}, {std::sqrt(0.6), 5.0 / 9.0}}) {
      const Vec3 x =
          0.5 * s * (s - 1.0) * begin + (1.0 - s * s) * middle + 0.5 * s * (s + 1.0) * end;
      const Vec3 dx = (s - 0.5) * begin - 2.0 * s * middle + (s + 0.5) * end;
      sum += 0.5 * weight * x.cross(dx);
    }
  return sum;
}

/// A 10 x 1 x 1 mm cantilever of hex20, fixed at x0, with pressure p on its upper face z1. Its free
/// end, and the border of the loaded face, rotate far.
test::Body cantilever(const FollowerPressure*& load, std::unique_ptr<FollowerPressure>& owner,
                      double p) {
  auto mesh = box_mesh({.cells = {10, 1, 1}, .size_mm = {10, 1, 1}, .shape = ElementShape::kHex20});
  owner = pressure_on(mesh, "z1", p);
  load = owner.get();
  auto prescribed = prescribe_zero(mesh.node_sets.at("x0"));
  return {std::move(mesh), {{0, kLaw}}, std::move(prescribed), {load}};
}

TEST(FollowerPressure, ACantileverWithAFreeBorderRotatesFarInEquilibriumWithItsSupport) {
  const FollowerPressure* load = nullptr;
  std::unique_ptr<FollowerPressure> owner;
  const double p = 1e-3;
  const test::Body body = cantilever(load, owner, p);
  EXPECT_FALSE(load->is_conservative(body.assembler.dofs()));
  const auto outcome = body.solve({.relative_tolerance = 1e-11, .max_iterations = 100});
  ASSERT_TRUE(outcome.converged()) << outcome.reason;
  EXPECT_LE(outcome.iterations(), 60);

  const auto at = [&](Vec3 X) {
    for (Index n = 0; n < body.mesh.node_count(); ++n)
      if ((body.mesh.nodes_L[std::size_t(n)] - X).norm() < 1e-9)
        return Vec3(X + outcome.x.segment<3>(3 * n));
    ADD_FAILURE() << "no node at " << X.transpose();
    return Vec3(Vec3::Zero());
  };
  const Vec3 end = at(Vec3(10, 0, 1)) - at(Vec3(9, 0, 1));
  EXPECT_LT(std::atan2(end.z(), end.x()), -0.9);  // Rotated down by more than 50 degrees.

  std::vector<std::array<Vec3, 3>> edges;
  for (int k = 0; k < 10; ++k) {
    edges.push_back({at(Vec3(k, 0, 1)), at(Vec3(k + 0.5, 0, 1)), at(Vec3(k + 1, 0, 1))});
    edges.push_back({at(Vec3(k + 1, 1, 1)), at(Vec3(k + 0.5, 1, 1)), at(Vec3(k, 1, 1))});
  }
  edges.push_back({at(Vec3(10, 0, 1)), at(Vec3(10, 0.5, 1)), at(Vec3(10, 1, 1))});
  edges.push_back({at(Vec3(0, 1, 1)), at(Vec3(0, 0.5, 1)), at(Vec3(0, 0, 1))});
  const Vec3 reaction = resultant(body.assembler.forces(outcome.x)->residual_n);
  EXPECT_LT((reaction - p * border_area(edges)).norm(), 1e-9 * reaction.norm());
}

/// A block on three symmetry planes with pressure p on its upper face: the border of that face is
/// free on two sides, and its area grows. mu (l - 1/l) + lambda ln(J) / l = -p w^2 along z, with
/// the lateral stretch w: mu (w - 1/w) + lambda ln(J) / w = 0, J = l w^2.
struct PressedBlock {
  double l = 1.0, w = 1.0;
  explicit PressedBlock(double p) {
    const auto bisect = [](double low, double high, const auto& f) {  // f is increasing.
      for (int n = 0; n < 200; ++n) {
        const double middle = 0.5 * (low + high);
        (f(middle) > 0.0 ? high : low) = middle;
      }
      return 0.5 * (low + high);
    };
    const auto width = [&](double along) {
      return bisect(0.1, 10.0, [&](double across) {
        return kLaw.mu_mpa * (across * across - 1.0) +
               kLaw.lambda_mpa * std::log(along * across * across);
      });
    };
    // Cauchy stress along z, which increases with l.
    l = bisect(0.02, 1.0, [&](double along) {
      const double across = width(along), J = along * across * across;
      return (kLaw.mu_mpa * (along * along - 1.0) + kLaw.lambda_mpa * std::log(J)) / J + p;
    });
    w = width(l);
  }
};

TEST_P(Pressures, WithAFreeBorderABlockMatchesTheClosedFormInQuadraticConvergence) {
  const auto mesh = box_mesh({.cells = {2, 2, 2}, .distortion = 0.15, .shape = GetParam()});
  const auto prescribed =
      test::joined({test::prescribe_component(mesh.node_sets.at("x0"), 0, 0.0),
                    test::prescribe_component(mesh.node_sets.at("y0"), 1, 0.0),
                    test::prescribe_component(mesh.node_sets.at("z0"), 2, 0.0)});
  const double young_mpa =
      kLaw.mu_mpa * (3.0 * kLaw.lambda_mpa + 2.0 * kLaw.mu_mpa) / (kLaw.lambda_mpa + kLaw.mu_mpa);
  const auto term = pressure_on(mesh, "z1", 0.0);
  const test::Body body(mesh, {{0, kLaw}}, prescribed, {term.get()});
  ASSERT_FALSE(term->is_conservative(body.assembler.dofs()));
  VectorX u = body.at_rest();
  for (const double part : {0.25, 0.5, 1.0, 2.0}) {
    const double p = part * young_mpa;
    term->set_pressure_mpa(p);
    linear::LinearSolver solver;
    const auto outcome = find_equilibrium(body.assembler, prescribed, u, solver,
                                          {.relative_tolerance = 1e-12, .max_iterations = 30});
    ASSERT_TRUE(outcome.converged()) << part << " of E: " << outcome.reason;
    EXPECT_LE(outcome.iterations(), 10) << part;
    u = outcome.x;
    const PressedBlock expected(p);
    Mat3 gradient = Mat3::Zero();
    gradient.diagonal() << expected.w - 1.0, expected.w - 1.0, expected.l - 1.0;
    EXPECT_LT((u - test::affine(mesh, gradient, Vec3::Zero())).lpNorm<Eigen::Infinity>(), 1e-9)
        << part << " of E";
    // With the symmetric part alone, convergence is linear: less than one digit per step here.
    for (std::size_t k = 0; k + 1 < outcome.history.size(); ++k) {
      const double before = outcome.history[k].residual_n / outcome.history[k].residual_reference_n;
      const double after =
          outcome.history[k + 1].residual_n / outcome.history[k + 1].residual_reference_n;
      if (before < 1e-4 && before > 1e-10) {
        EXPECT_LT(after, 1e-2 * before) << part << " of E";
      }
    }
  }
}

TEST(FollowerPressure, WithAFreeBorderTheTangentIsTheSymmetricPartOfTheDerivative) {
  const auto mesh = box_mesh({.cells = {1, 1, 1}, .shape = ElementShape::kHex20});
  const auto term = pressure_on(mesh, "z1", 0.7);
  const Assembler assembler = assembler_of(mesh, *term);
  const VectorX u = shaken(mesh, 0.1, 6);
  Eigen::MatrixXd derivative(u.size(), u.size());
  const double h = 1e-4;
  for (Index k = 0; k < u.size(); ++k) {
    const VectorX step = h * VectorX::Unit(u.size(), k);
    derivative.col(k) =
        (assembler.forces(u + step)->residual_n - assembler.forces(u - step)->residual_n) / (2 * h);
  }
  ASSERT_GT((derivative - derivative.transpose()).norm(), 0.1);
  const Eigen::MatrixXd half = 0.5 * (derivative + derivative.transpose());
  const Eigen::MatrixXd lower = assembler.tangent(u);
  EXPECT_LT(Eigen::MatrixXd((lower - half).triangularView<Eigen::Lower>()).norm(), 1e-9);
  const Eigen::MatrixXd below = assembler.antisymmetric_tangent(u);
  const Eigen::MatrixXd other_half = 0.5 * (derivative - derivative.transpose());
  EXPECT_LT((below - below.transpose() - other_half).norm(), 1e-9);
  // All of it is follower force; there is no energy.
  const auto forces = assembler.forces(u);
  EXPECT_EQ(forces->follower_n, forces->residual_n);
  EXPECT_EQ(forces->energy_mj, 0.0);
}

TEST(FollowerPressure, InACavityTheForceOnEachWallIsPressureTimesArea) {
  // 3 x 3 x 3 cubes of 1 mm without the one in the middle.
  auto mesh = box_mesh({.cells = {3, 3, 3}, .size_mm = {3, 3, 3}, .shape = ElementShape::kHex8});
  std::vector<mesh::Face> walls;
  for (Index e = 0; e < mesh.element_count(); ++e) {
    Vec3 center = Vec3::Zero();
    for (int a = 0; a < 8; ++a)
      center += mesh.nodes_L[std::size_t(mesh.blocks[0].element(e)[a])] / 8.0;
    if ((center - Vec3::Constant(1.5)).norm() > 0.1) continue;
    for (const mesh::LocalFace& local : mesh::faces_of(ElementShape::kHex8)) {
      mesh::Face wall = mesh::face_of(mesh.blocks[0].element(e), local);
      std::reverse(wall.nodes.begin(),
                   wall.nodes.begin() + 4);  // Outward from the body, into the cavity.
      walls.push_back(wall);
    }
  }
  ASSERT_EQ(walls.size(), 6U);
  const auto all_walls = FollowerPressure::build(mesh.nodes_L, walls).value();
  all_walls->set_pressure_mpa(0.7);
  const Assembler assembler = assembler_of(mesh, *all_walls);
  EXPECT_TRUE(all_walls->is_conservative(assembler.dofs()));
  test::RandomDeformation random(7);
  const Mat3 F = random.gradient();
  const auto forces = assembler.forces(test::affine(mesh, F - Mat3::Identity(), Vec3(1, 2, 3)));
  // The energy decreases as the cavity grows.
  EXPECT_NEAR(forces->energy_mj, -0.7 * (F.determinant() - 1.0), 1e-12);
  EXPECT_LT(resultant(forces->residual_n).norm(), 1e-12);

  for (const mesh::Face& wall : walls) {
    const auto one = FollowerPressure::build(mesh.nodes_L, {wall}).value();
    one->set_pressure_mpa(0.7);
    Vec3 middle = Vec3::Zero();
    for (int a = 0; a < 4; ++a)
      middle += mesh.nodes_L[std::size_t(wall.nodes[std::size_t(a)])] / 4.0;
    const Vec3 outward = (middle - Vec3::Constant(1.5)).normalized();
    const Vec3 force = -resultant(
        assembler_of(mesh, *one).forces(VectorX::Zero(3 * mesh.node_count()))->residual_n);
    EXPECT_LT((force - 0.7 * outward).norm(), 1e-14);
  }
}

TEST(FollowerPressure, RejectsInvalidFaces) {
  const auto mesh = box_mesh({.cells = {1, 1, 1}});
  auto faces = mesh.face_sets.at("x1");
  faces[1].nodes[0] = -1;
  const auto refused = FollowerPressure::build(mesh.nodes_L, faces);
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().code, ErrorCode::kMeshInvalid);
  EXPECT_EQ(refused.error().message, "face 1 names node -1, must be 0 to 7");
}

}  // namespace
}  // namespace lefort::fem::test_follower_pressure
