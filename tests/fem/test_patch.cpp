/// Patch test of elements of all shapes, single and mixed.
#include <lefort/fem/assembly/element_term.h>
#include <lefort/fem/faces/all_faces.h>
#include <lefort/mesh/box_grid.h>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include <random>
#include <span>
#include <variant>

#include "fem/body.h"
#include "fem/random_deformation.h"

namespace lefort::fem::test_patch {
namespace {

using mesh::BoxMix;
using mesh::ElementShape;
using mesh::VolumeMesh;

constexpr NeoHookean kLaw{.mu_mpa = 0.5, .lambda_mpa = 2.0};
const Vec3 kSize_mm(4, 3, 3);

constexpr BoxMix kMixes[] = {BoxMix::kAllLinear, BoxMix::kHex20Wedge15, BoxMix::kWedge15Tet10};

VolumeMesh distorted_mix(BoxMix mix) {
  std::mt19937 random(11);
  return mesh::with_inner_nodes_moved(mesh::make_mixed_box(mix, {4, 3, 3}, kSize_mm),
                                      Vec3::Constant(0.15), random);
}

/// F - I with large strain and a rotation.
Mat3 large_strain() {
  Mat3 A;
  A << 0.30, 0.15, -0.12, 0.23, -0.18, 0.14, -0.16, 0.12, 0.22;
  return A;
}

class Patch : public testing::TestWithParam<BoxMix> {};
INSTANTIATE_TEST_SUITE_P(Mixes, Patch, testing::ValuesIn(kMixes));

TEST_P(Patch, EquilibriumUnderAnAffineBoundaryIsAffine) {
  const VolumeMesh mesh = distorted_mix(GetParam());
  const VectorX expected = test::affine(mesh, large_strain(), Vec3(0.1, -0.2, 0.3));
  for (const Material& law :
       {Material(kLaw), Material(LinearElastic{.mu_mpa = 0.5, .lambda_mpa = 2.0})}) {
    const test::Body body(mesh, {{0, law}},
                          test::prescribe(mesh.node_sets.at("boundary"), expected));
    ASSERT_GT(body.assembler.dofs().free_count(), 30);
    const auto outcome = body.solve({.relative_tolerance = 1e-13});
    ASSERT_TRUE(outcome.converged()) << outcome.reason;
    EXPECT_LT((outcome.x - expected).lpNorm<Eigen::Infinity>(), 1e-12);
  }
}

/// Adds the integral of each shape function over the area vectors of a face.
void add_area(const mesh::Face& face, std::span<const Vec3> X_L, Eigen::Matrix3Xd& area) {
  std::visit(
      [&]<class Shape>(const Shape&) {
        const FaceNodes<Shape> X = face_nodes<Shape>(face, X_L);
        for (const auto& point : Shape::quadrature()) {
          const Vec3 around = area_vector_mm2(tangents<Shape>(X, point), point.weight);
          for (int a = 0; a < Shape::kNodes; ++a)
            area.col(face.nodes[std::size_t(a)]) += point.N[a] * around;
        }
      },
      face_of(face.shape));
}

TEST_P(Patch, AnAffineDeformationHasItsEnergyAndForcesOnTheBoundaryOnly) {
  const VolumeMesh mesh = distorted_mix(GetParam());
  const test::Body body(mesh, {{0, kLaw}}, {});
  const Mat3 F = Mat3::Identity() + large_strain();
  const auto forces = body.assembler.forces(test::affine(mesh, large_strain(), Vec3::Zero()));
  ASSERT_TRUE(forces.has_value());
  EXPECT_NEAR(forces->energy_mj, kSize_mm.prod() * kLaw.energy(F), 1e-12 * forces->energy_mj);
  const Mat3 P = kLaw.stress(F);
  // The force on a boundary node is P times the area vectors around it.
  Eigen::Matrix3Xd area = Eigen::Matrix3Xd::Zero(3, mesh.node_count());
  for (const mesh::Face& face : mesh.face_sets.at("boundary")) add_area(face, mesh.nodes_L, area);
  for (Index n = 0; n < mesh.node_count(); ++n)
    EXPECT_LT((forces->residual_n.segment<3>(3 * n) - P * area.col(n)).norm(), 1e-13) << n;
}

TEST_P(Patch, ARigidMotionCausesNoForce) {
  const test::Body body(distorted_mix(GetParam()), {{0, kLaw}}, {});
  test::RandomDeformation random(5);
  for (int n = 0; n < 5; ++n) {
    const auto forces = body.assembler.forces(
        test::affine(body.mesh, random.rotation() - Mat3::Identity(), Vec3(10, -20, 30)));
    ASSERT_TRUE(forces.has_value());
    EXPECT_LT(forces->residual_n.lpNorm<Eigen::Infinity>(), 1e-12);
    EXPECT_NEAR(forces->energy_mj, 0.0, 1e-12);
  }
}

/// With curved interior edges, too: the rules of hex20 and wedge15 are exact for them, the four
/// points of tet10 are not.
TEST(PatchOfCurvedElements, UniformStressIsInEquilibrium) {
  VolumeMesh mesh = distorted_mix(BoxMix::kHex20Wedge15);
  std::vector<char> is_boundary(mesh.nodes_L.size(), 0);
  for (const std::int32_t node : mesh.node_sets.at("boundary")) is_boundary[std::size_t(node)] = 1;
  test::RandomDeformation random(6);
  for (std::size_t n = 0; n < mesh.nodes_L.size(); ++n)
    if (is_boundary[n] == 0) mesh.nodes_L[n] += 0.05 * random.matrix().col(0);
  const test::Body body(mesh, {{0, kLaw}}, {});
  const auto forces = body.assembler.forces(test::affine(mesh, large_strain(), Vec3::Zero()));
  ASSERT_TRUE(forces.has_value());
  for (Index n = 0; n < mesh.node_count(); ++n)
    if (is_boundary[std::size_t(n)] == 0) {
      EXPECT_LT(forces->residual_n.segment<3>(3 * n).norm(), 1e-12);
    }
}

/// A single element has zero energy in rigid motions only.
class SingleElement : public testing::TestWithParam<ElementShape> {};
INSTANTIATE_TEST_SUITE_P(Shapes, SingleElement, testing::ValuesIn(test::kAllElements),
                         test::shape_name);

TEST_P(SingleElement, HasExactlySixModesWithoutStiffness) {
  VolumeMesh mesh = mesh::make_box(GetParam(), {1, 1, 1}, Vec3(1.0, 1.2, 0.9));
  test::RandomDeformation random(8);
  for (Vec3& node : mesh.nodes_L) node += 0.05 * random.matrix().col(0);
  const auto terms = make_element_terms(mesh, {{0, kLaw}}).value();
  const auto nodes = terms[0]->nodes(0);
  const auto size = 3 * Index(nodes.size());
  std::vector<Vec3> x_L;
  for (const std::int32_t node : nodes) x_L.push_back(mesh.nodes_L[std::size_t(node)]);
  VectorX residual = VectorX::Zero(size);
  Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(size, size);
  LocalEquations local{
      .residual_n = Eigen::Map<VectorX>(residual.data(), size),
      .stiffness_n_per_mm = Eigen::Map<Eigen::MatrixXd>(stiffness.data(), size, size)};
  ASSERT_TRUE(terms[0]->evaluate(0, x_L, local));
  const VectorX modes = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(stiffness).eigenvalues();
  EXPECT_LT(modes.head(6).lpNorm<Eigen::Infinity>(), 1e-13 * modes[size - 1]);
  EXPECT_GT(modes[6], 1e-4 * modes[size - 1]);
}

}  // namespace
}  // namespace lefort::fem::test_patch
