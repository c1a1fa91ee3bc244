/// Properties of elements with decoupled laws that average the change of volume.
#include <lefort/core/parallel.h>
#include <lefort/fem/assembly/element_state.h>
#include <lefort/fem/assembly/element_term.h>
#include <lefort/fem/locking/nodal_pressure.h>
#include <lefort/mesh/box_grid.h>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "fem/body.h"
#include "fem/random_deformation.h"
#include "support/box_mesh.h"

namespace lefort::fem::test_volumetric_integration {
namespace {

using mesh::BoxMix;
using mesh::ElementShape;
using test::affine;
using test::box_mesh;

DecoupledLaw<IsochoricNeoHookean> law_of(double mu_mpa, double kappa_mpa) {
  return {.isochoric = {.mu_mpa = mu_mpa},
          .volume = {.form = VolumetricForm::kQuadraticLog, .kappa_mpa = kappa_mpa}};
}

const Material kNearlyIncompressible = law_of(0.5, 500.0);
const Material kModerate = law_of(0.5, 5.0);

VectorX shaken(const mesh::VolumeMesh& mesh, double max_displacement_mm, unsigned seed) {
  test::RandomDeformation random(seed);
  return VectorX::NullaryExpr(3 * mesh.node_count(),
                              [&] { return max_displacement_mm * random.number(); });
}

constexpr std::array kAveraged{ElementShape::kHex8, ElementShape::kTet10, ElementShape::kWedge15,
                               ElementShape::kHex20};
constexpr std::array kPointwise{ElementShape::kTet4, ElementShape::kWedge6,
                                ElementShape::kPyramid5};

class AveragedVolumes : public testing::TestWithParam<ElementShape> {};
INSTANTIATE_TEST_SUITE_P(Shapes, AveragedVolumes, testing::ValuesIn(kAveraged), test::shape_name);

class PointwiseVolumes : public testing::TestWithParam<ElementShape> {};
INSTANTIATE_TEST_SUITE_P(Shapes, PointwiseVolumes, testing::ValuesIn(kPointwise), test::shape_name);

class VolumetricIntegrations : public testing::TestWithParam<ElementShape> {};
INSTANTIATE_TEST_SUITE_P(Shapes, VolumetricIntegrations, testing::ValuesIn(test::kAllElements),
                         test::shape_name);

TEST_P(VolumetricIntegrations, ForcesAndTangentAreDerivativesOfTheEnergy) {
  const auto mesh = box_mesh({.cells = {1, 2, 1}, .size_mm = {2, 3, 2}, .shape = GetParam()});
  const test::Body body(mesh, {{0, kModerate}}, {});
  const VectorX u = shaken(mesh, 0.06, 1);
  const auto here = body.assembler.forces(u);
  ASSERT_TRUE(here.has_value());
  const Eigen::MatrixXd lower = body.assembler.tangent(u);
  const double h = 1e-5;
  for (Index k = 0; k < u.size(); ++k) {
    const VectorX step = h * VectorX::Unit(u.size(), k);
    const auto plus = body.assembler.forces(u + step);
    const auto minus = body.assembler.forces(u - step);
    EXPECT_NEAR(here->residual_n[k], (plus->energy_mj - minus->energy_mj) / (2 * h), 2e-8);
    const VectorX column = (plus->residual_n - minus->residual_n) / (2 * h);
    EXPECT_LT((lower.col(k) - column).tail(u.size() - k).norm(), 1e-7 * lower.norm());
  }
}

TEST_P(AveragedVolumes, TheStabilizedTangentOmitsTheGeometricPartOfThePressure) {
  // Without pressure both are equal; under pressure they differ.
  const auto mesh = box_mesh({.cells = {1, 1, 1}, .shape = GetParam()});
  const test::Body body(mesh, {{0, kModerate}}, {});
  const auto difference = [&](const VectorX& u) {
    return (body.assembler.tangent(u, Tangent::kStabilized) - body.assembler.tangent(u)).norm();
  };
  EXPECT_LT(difference(body.at_rest()), 1e-12);
  EXPECT_GT(difference(affine(mesh, 0.1 * Mat3::Identity(), Vec3::Zero())), 0.1);
}

TEST_P(VolumetricIntegrations, AnAffineDeformationHasTheEnergyOfTheLaw) {
  const auto mesh =
      box_mesh({.cells = {3, 2, 2}, .size_mm = {4, 3, 2}, .distortion = 0.15, .shape = GetParam()});
  const test::Body body(mesh, {{0, kModerate}}, {});
  test::RandomDeformation random(4);
  const Mat3 F = random.gradient();
  const auto forces = body.assembler.forces(affine(mesh, F - Mat3::Identity(), Vec3(1, 2, 3)));
  ASSERT_TRUE(forces.has_value());
  const double expected = 24.0 * law_of(0.5, 5.0).energy(F);
  EXPECT_NEAR(forces->energy_mj, expected, 1e-11 * expected);
}

TEST_P(VolumetricIntegrations, ARigidMotionCausesNoForce) {
  const test::Body body(box_mesh({.cells = {2, 2, 2}, .distortion = 0.15, .shape = GetParam()}),
                        {{0, kNearlyIncompressible}}, {});
  test::RandomDeformation random(5);
  for (int n = 0; n < 5; ++n) {
    const auto forces = body.assembler.forces(
        affine(body.mesh, random.rotation() - Mat3::Identity(), Vec3(10, -20, 30)));
    ASSERT_TRUE(forces.has_value());
    EXPECT_LT(forces->residual_n.norm(), 1e-10);
    EXPECT_NEAR(forces->energy_mj, 0.0, 1e-12);
  }
}

TEST_P(VolumetricIntegrations, PatchTestReproducesAnAffineDisplacement) {
  const auto mesh =
      box_mesh({.cells = {3, 3, 3}, .size_mm = {3, 3, 3}, .distortion = 0.19, .shape = GetParam()});
  Mat3 A;
  A << 0.10, 0.05, -0.02, 0.03, -0.08, 0.04, -0.06, 0.02, 0.12;
  const VectorX expected = affine(mesh, A, Vec3(0.1, -0.2, 0.3));
  const test::Body body(mesh, {{0, kNearlyIncompressible}},
                        test::prescribe(mesh.node_sets.at("outside"), expected));
  ASSERT_GT(body.assembler.dofs().free_count(), 0);
  const auto outcome = body.solve({.relative_tolerance = 1e-12});
  ASSERT_TRUE(outcome.converged()) << outcome.reason;
  EXPECT_LT((outcome.x - expected).lpNorm<Eigen::Infinity>(), 1e-11);
}

/// Number of modes much stiffer than shear, and of modes without stiffness.
struct Stiffness {
  int stiff = 0;
  int free = 0;
};

Stiffness stiffness_of(const mesh::VolumeMesh& mesh, VolumetricIntegration volumetric_integration) {
  const double kappa = 1e6;
  const test::Body body(mesh, {{0, law_of(1.0, kappa)}}, {}, {}, volumetric_integration);
  const Eigen::MatrixXd lower = body.assembler.tangent(body.at_rest());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(lower, Eigen::EigenvaluesOnly);
  Stiffness found;
  for (const double value : modes.eigenvalues()) {
    if (value > 1e-4 * kappa) ++found.stiff;
    if (std::abs(value) < 1e-7) ++found.free;
  }
  return found;
}

TEST_P(AveragedVolumes, ThereAreAsManyVolumetricModesAsAveragesAndOnlyRigidModesAreFree) {
  const ElementShape shape = GetParam();
  const auto mesh = box_mesh({.cells = {2, 2, 2}, .size_mm = {2, 2, 2}, .shape = shape});
  const Index means = shape == ElementShape::kHex8 ? mesh.element_count() : 27;  // Corner nodes.
  const Stiffness averaged = stiffness_of(mesh, VolumetricIntegration::kMeanDilatation);
  EXPECT_EQ(averaged.free, 6);
  EXPECT_LE(averaged.stiff, means);
  const Stiffness pointwise = stiffness_of(mesh, VolumetricIntegration::kFullIntegration);
  EXPECT_EQ(pointwise.free, 6);
  EXPECT_LT(averaged.stiff, pointwise.stiff);
}

TEST_P(VolumetricIntegrations, AnInvertedElementIsInadmissible) {
  const auto mesh = box_mesh({.cells = {2, 1, 1}, .shape = GetParam()});
  const test::Body body(mesh, {{0, kModerate}}, {});
  VectorX u = body.at_rest();
  const std::int32_t corner = mesh.blocks[0].nodes[0];
  u.segment<3>(3 * Index(corner)) = Vec3(2.5, 2.5, 2.5) - mesh.nodes_L[std::size_t(corner)];
  EXPECT_FALSE(body.assembler.forces(u).has_value());
  u[3 * Index(corner)] = std::nan("");
  EXPECT_FALSE(body.assembler.forces(u).has_value());
}

TEST_P(AveragedVolumes, WithFullIntegrationTheLawIsWhole) {
  const auto mesh = box_mesh({.cells = {2, 1, 1}, .distortion = 0.1, .shape = GetParam()});
  const test::Body pointwise(mesh, {{0, kModerate}}, {}, {},
                             VolumetricIntegration::kFullIntegration);
  const test::Body averaged(mesh, {{0, kModerate}}, {});
  const VectorX u = shaken(mesh, 0.02, 6);
  const double whole = pointwise.assembler.forces(u)->energy_mj;
  EXPECT_EQ(pointwise.terms.size(), 1U);
  EXPECT_GT(whole, 1.02 * averaged.assembler.forces(u)->energy_mj);
}

TEST_P(VolumetricIntegrations, OtherLawsAreUnaffectedAndMayBeMixed) {
  auto mesh = box_mesh({.cells = {2, 1, 1}, .shape = GetParam()});
  const NeoHookean other{.mu_mpa = 0.5, .lambda_mpa = 2.0};
  const VectorX u = shaken(mesh, 0.03, 7);
  const test::Body averaged(mesh, {{0, other}}, {});
  const test::Body pointwise(mesh, {{0, other}}, {}, {}, VolumetricIntegration::kFullIntegration);
  EXPECT_EQ(averaged.terms.size(), 1U);
  EXPECT_EQ(averaged.assembler.forces(u)->residual_n, pointwise.assembler.forces(u)->residual_n);

  for (std::size_t e = mesh.blocks[0].region.size() / 2; e < mesh.blocks[0].region.size(); ++e)
    mesh.blocks[0].region[e] = 1;
  const test::Body both(mesh, {{0, kModerate}, {1, other}}, {});
  const Mat3 F = Vec3(1.2, 0.9, 1.1).asDiagonal();
  const auto forces = both.assembler.forces(affine(mesh, F - Mat3::Identity(), Vec3::Zero()));
  const double expected = 0.5 * law_of(0.5, 5.0).energy(F) + 0.5 * other.energy(F);
  EXPECT_NEAR(forces->energy_mj, expected, 1e-13);
}

TEST_P(VolumetricIntegrations, AveragesDoNotCrossTheBoundaryOfARegion) {
  auto mesh = box_mesh({.cells = {2, 1, 1}, .shape = GetParam()});
  for (std::size_t e = mesh.blocks[0].region.size() / 2; e < mesh.blocks[0].region.size(); ++e)
    mesh.blocks[0].region[e] = 1;
  const auto soft = law_of(0.5, 5.0);
  const auto stiff = law_of(2.0, 90.0);
  const test::Body body(mesh, {{0, soft}, {1, stiff}}, {});
  const Mat3 F = Vec3(1.2, 0.9, 1.1).asDiagonal();
  const auto forces = body.assembler.forces(affine(mesh, F - Mat3::Identity(), Vec3::Zero()));
  EXPECT_NEAR(forces->energy_mj, 0.5 * soft.energy(F) + 0.5 * stiff.energy(F), 1e-12);
}

TEST_P(AveragedVolumes, StatesReportTheStressAndEnergyOfTheAverage) {
  const auto mesh = box_mesh({.cells = {2, 2, 2}, .shape = GetParam()});
  Mat3 F;
  F << 1.2, 0.1, 0.0, -0.2, 0.9, 0.3, 0.0, 0.1, 1.1;
  const auto law = law_of(0.5, 5.0);
  for (const ElementState& state :
       element_states(mesh, {{0, law}}, affine(mesh, F - Mat3::Identity(), Vec3(1, 2, 3)))) {
    EXPECT_LT((state.cauchy_mpa - cauchy_stress(law.stress(F), F)).norm(), 1e-12);
    EXPECT_NEAR(state.energy_density_mpa, law.energy(F), 1e-13);
  }
  // The elements of this box have one size: their energies add up to that of the terms.
  const VectorX u = shaken(mesh, 0.01, 8);
  const test::Body body(mesh, {{0, law}}, {});
  const auto states = element_states(mesh, {{0, law}}, u);
  double sum = 0.0;
  for (const ElementState& state : states) sum += state.energy_density_mpa / double(states.size());
  EXPECT_NEAR(sum, body.assembler.forces(u)->energy_mj, 1e-13);
  const auto pointwise =
      element_states(mesh, {{0, law}}, u, VolumetricIntegration::kFullIntegration);
  EXPECT_GT((states[0].cauchy_mpa - pointwise[0].cauchy_mpa).norm(), 1e-4);
}

TEST_P(VolumetricIntegrations, NeighborsOfAnInvertedElementHaveNoStress) {
  const auto mesh = box_mesh({.cells = {1, 1, 1}, .shape = GetParam()});
  const Mat3 mirror = Vec3(-1, 1, 1).asDiagonal();
  const auto states =
      element_states(mesh, {{0, kModerate}}, affine(mesh, mirror - Mat3::Identity(), Vec3::Zero()));
  EXPECT_NEAR(states[0].min_volume_ratio, -1.0, 1e-13);
  EXPECT_TRUE(std::isnan(states[0].energy_density_mpa));
}

TEST_P(VolumetricIntegrations, SameBitsForAnyNumberOfThreads) {
  const auto mesh = box_mesh({.cells = {3, 3, 3}, .distortion = 0.1, .shape = GetParam()});
  const VectorX u = shaken(mesh, 0.01, 9);
  const auto with_threads = [&](int threads) {
    const ThreadLimit limit(threads);
    const test::Body body(mesh, {{0, kModerate}}, {});
    VectorX all = body.assembler.forces(u)->residual_n;
    const linear::SparseMatrix K = body.assembler.tangent(u);
    const auto states = element_states(mesh, {{0, kModerate}}, u);
    all.conservativeResize(u.size() + K.nonZeros() + 1);
    all.tail(K.nonZeros() + 1) << Eigen::Map<const VectorX>(K.valuePtr(), K.nonZeros()),
        states.back().cauchy_mpa.sum();
    return all;
  };
  EXPECT_EQ(with_threads(1), with_threads(2));
}

class MixedVolumetricIntegrations : public testing::TestWithParam<BoxMix> {};
INSTANTIATE_TEST_SUITE_P(Mixes, MixedVolumetricIntegrations,
                         testing::Values(BoxMix::kAllLinear, BoxMix::kHex20Wedge15,
                                         BoxMix::kWedge15Tet10));

TEST_P(MixedVolumetricIntegrations, MixedShapesPassThePatchTest) {
  std::mt19937 random(11);
  const auto mesh = mesh::with_inner_nodes_moved(
      mesh::make_mixed_box(GetParam(), {4, 3, 3}, Vec3(4, 3, 3)), Vec3::Constant(0.15), random);
  Mat3 A;
  A << 0.10, 0.05, -0.02, 0.03, -0.08, 0.04, -0.06, 0.02, 0.12;
  const VectorX expected = affine(mesh, A, Vec3(0.1, -0.2, 0.3));
  const test::Body body(mesh, {{0, kNearlyIncompressible}},
                        test::prescribe(mesh.node_sets.at("boundary"), expected));
  const auto outcome = body.solve({.relative_tolerance = 1e-12});
  ASSERT_TRUE(outcome.converged()) << outcome.reason;
  EXPECT_LT((outcome.x - expected).lpNorm<Eigen::Infinity>(), 1e-11);
}

TEST(NodalPressure, TooManyElementsAroundANodeAreDividedBetweenSeveralPatches) {
  // A fan of 80 tetrahedra around the axis from node 0 to node 1: more nodes than an item may have.
  mesh::VolumeMesh mesh;
  mesh.nodes_L = {Vec3(0, 0, 0), Vec3(0, 0, 1)};
  mesh::ElementBlock& block = mesh.blocks.emplace_back();
  block.shape = ElementShape::kTet10;
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middles;
  const int count = 80;
  for (int k = 0; k < count; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / count;
    mesh.nodes_L.emplace_back(std::cos(angle), std::sin(angle), 0.0);
  }
  for (int k = 0; k < count; ++k) {
    const std::array<std::int32_t, 4> corners{0, 2 + k, 2 + (k + 1) % count, 1};
    block.nodes.insert(block.nodes.end(), corners.begin(), corners.end());
    for (const auto& [a, b] : Tet10::kEdges) {
      const auto ends = std::minmax(corners[std::size_t(a)], corners[std::size_t(b)]);
      const auto [known, is_new] = middles.try_emplace(ends, std::int32_t(mesh.nodes_L.size()));
      if (is_new)
        mesh.nodes_L.push_back(
            0.5 * (mesh.nodes_L[std::size_t(ends.first)] + mesh.nodes_L[std::size_t(ends.second)]));
      block.nodes.push_back(known->second);
    }
    block.region.push_back(0);
  }
  const auto term = NodalPressure::build(mesh, {{0, kModerate}});
  ASSERT_NE(term, nullptr);
  // 82 corners; all elements meet at the two on the axis, which have several patches.
  EXPECT_GT(term->item_count(), 82);
  for (Index item = 0; item < term->item_count(); ++item)
    EXPECT_LE(term->nodes(item).size(), std::size_t(kMaxLocalNodes));
  const test::Body body(mesh, {{0, kModerate}}, {});
  const Mat3 F = Vec3(1.2, 0.9, 1.1).asDiagonal();
  const double volume_mm3 = count * 0.5 * std::sin(2.0 * std::numbers::pi / count) / 3.0;
  EXPECT_NEAR(body.assembler.forces(affine(mesh, F - Mat3::Identity(), Vec3::Zero()))->energy_mj,
              volume_mm3 * law_of(0.5, 5.0).energy(F), 1e-12);
}

TEST(NodalPressure, HasOnePatchPerCornerNodeAndRegion) {
  for (const ElementShape shape : {ElementShape::kTet10, ElementShape::kWedge15}) {
    auto mesh = box_mesh({.cells = {2, 2, 2}, .shape = shape});
    EXPECT_EQ(NodalPressure::build(mesh, {{0, kModerate}})->item_count(), 27);
    for (std::size_t e = mesh.blocks[0].region.size() / 2; e < mesh.blocks[0].region.size(); ++e)
      mesh.blocks[0].region[e] = 1;
    EXPECT_EQ(NodalPressure::build(mesh, {{0, kModerate}, {1, kModerate}})->item_count(), 36);
  }
}

TEST(NodalPressure, CornersOfOneHex20HaveNoPressureOfTheirOwn) {
  const auto items = [](const std::array<int, 3>& cells) {
    const auto mesh = box_mesh({.cells = cells, .shape = ElementShape::kHex20});
    return NodalPressure::build(mesh, {{0, kModerate}})->item_count();
  };
  EXPECT_EQ(items({2, 2, 2}), 27 - 8);
  EXPECT_EQ(items({1, 1, 2}), 12 - 8);
  EXPECT_EQ(items({1, 1, 1}), 8);  // Without another element they keep it.
}

TEST_P(PointwiseVolumes, TheLawIsEvaluatedAtThePoints) {
  const auto mesh = box_mesh({.cells = {2, 2, 1}, .distortion = 0.1, .shape = GetParam()});
  const VectorX u = shaken(mesh, 0.02, 6);
  const test::Body body(mesh, {{0, kModerate}}, {});
  const test::Body pointwise(mesh, {{0, kModerate}}, {}, {},
                             VolumetricIntegration::kFullIntegration);
  EXPECT_EQ(body.terms.size(), 1U);
  EXPECT_EQ(body.assembler.forces(u)->residual_n, pointwise.assembler.forces(u)->residual_n);
}

/// \returns the bending force of a beam of some layers, relative to Timoshenko's beam: L^3 / (3 E I)
///   + L / (k G A)
/// with Cowper's k for a rectangle. The lower edge of the far end is moved by a thousandth of the
/// length.
double stiffness_over_beam(ElementShape shape, int layers, double poisson) {
  const double length_mm = 10.0, mu_mpa = 1.0, deflection_mm = 0.01;
  const double kappa_mpa = 2.0 * mu_mpa * (1.0 + poisson) / (3.0 * (1.0 - 2.0 * poisson));
  auto mesh = box_mesh(
      {.cells = {5 * layers, layers, layers}, .size_mm = {length_mm, 1, 1}, .shape = shape});
  auto prescribed = prescribe_zero(mesh.node_sets.at("x0"));
  std::vector<std::int32_t> tip;
  for (const std::int32_t node : mesh.node_sets.at("x1"))
    if (std::abs(mesh.nodes_L[std::size_t(node)].z() - 0.5) < 1e-9) tip.push_back(node);
  for (const std::int32_t node : tip)
    prescribed.push_back({.node = node, .component = 2, .displacement_mm = deflection_mm});
  const test::Body body(std::move(mesh), {{0, law_of(mu_mpa, kappa_mpa)}}, std::move(prescribed));
  const auto outcome = body.solve({.relative_tolerance = 1e-7});
  EXPECT_TRUE(outcome.converged()) << outcome.reason;
  const VectorX force_n = body.assembler.forces(outcome.x)->residual_n;
  double tip_n = 0.0;
  for (const std::int32_t node : tip) tip_n += force_n[3 * Index(node) + 2];
  const double young_mpa = 2.0 * mu_mpa * (1.0 + poisson);
  const double k = 10.0 * (1.0 + poisson) / (12.0 + 11.0 * poisson);
  const double beam_n = deflection_mm / (std::pow(length_mm, 3) / (3.0 * young_mpa / 12.0) +
                                         length_mm / (k * mu_mpa));
  return tip_n / beam_n;
}

TEST(NodalPressure, AFewLayersResistBending) {
  // A single layer is 8 to 10 % too soft at nu = 0.3, and 5 to 15 % too stiff at 0.4999
  // (docs/theory/locking.md).
  for (const ElementShape shape :
       {ElementShape::kTet10, ElementShape::kWedge15, ElementShape::kHex20}) {
    EXPECT_NEAR(stiffness_over_beam(shape, 1, 0.3), 1.0, 0.1) << mesh::name_of(shape);
    EXPECT_NEAR(stiffness_over_beam(shape, 1, 0.4999), 1.0, 0.2) << mesh::name_of(shape);
    for (const double poisson : {0.3, 0.45, 0.4999})
      EXPECT_NEAR(stiffness_over_beam(shape, 2, poisson), 1.0, 0.06)
          << mesh::name_of(shape) << " " << poisson;
  }
}
}  // namespace
}  // namespace lefort::fem::test_volumetric_integration
