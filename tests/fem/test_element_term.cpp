#include <lefort/fem/assembly/element_term.h>
#include <lefort/mesh/element_faces.h>

#include <gtest/gtest.h>

#include <limits>

#include "fem/body.h"
#include "fem/random_deformation.h"
#include "support/box_mesh.h"

namespace lefort::fem::test_element_term {
namespace {

using mesh::ElementShape;
using test::box_mesh;

constexpr NeoHookean kSoft{.mu_mpa = 0.5, .lambda_mpa = 2.0};
constexpr NeoHookean kStiff{.mu_mpa = 3.0, .lambda_mpa = 2.0};

/// Results of one local item.
struct LocalResult {
  bool admissible;
  double energy_mj;
  VectorX residual_n;
  Eigen::MatrixXd stiffness_n_per_mm;
};

LocalResult evaluate(const ForceTerm& term, Index item, const std::vector<Vec3>& x_L) {
  const auto size = 3 * Index(x_L.size());
  LocalResult result{.admissible = false,
                     .energy_mj = 0.0,
                     .residual_n = VectorX::Zero(size),
                     .stiffness_n_per_mm = Eigen::MatrixXd::Zero(size, size)};
  LocalEquations local{.residual_n = Eigen::Map<VectorX>(result.residual_n.data(), size),
                       .stiffness_n_per_mm = Eigen::Map<Eigen::MatrixXd>(
                           result.stiffness_n_per_mm.data(), size, size)};
  result.admissible = term.evaluate(item, x_L, local);
  result.energy_mj = local.energy_mj;
  return result;
}

class ElementTerms : public testing::TestWithParam<ElementShape> {};
INSTANTIATE_TEST_SUITE_P(Shapes, ElementTerms, testing::ValuesIn(test::kAllElements),
                         test::shape_name);

TEST_P(ElementTerms, ResidualAndStiffnessAreDerivativesOfTheEnergy) {
  const auto mesh = box_mesh({.cells = {1, 1, 1}, .size_mm = {2, 3, 4}, .shape = GetParam()});
  const auto terms = make_element_terms(mesh, {{0, kSoft}}).value();
  const ForceTerm& term = *terms.front();
  test::RandomDeformation random(3);
  for (Index item = 0; item < term.item_count(); ++item) {
    std::vector<Vec3> x_L;
    for (const std::int32_t node : term.nodes(item))
      x_L.emplace_back(mesh.nodes_L[std::size_t(node)] + 0.08 * random.matrix().col(0));
    const LocalResult here = evaluate(term, item, x_L);
    ASSERT_TRUE(here.admissible);
    EXPECT_LT((here.stiffness_n_per_mm - here.stiffness_n_per_mm.transpose()).norm(), 1e-13);
    const double h = 1e-5;
    for (std::size_t a = 0; a < x_L.size(); ++a)
      for (int c = 0; c < 3; ++c) {
        auto forward = x_L;
        auto backward = x_L;
        forward[a][c] += h;
        backward[a][c] -= h;
        const LocalResult plus = evaluate(term, item, forward);
        const LocalResult minus = evaluate(term, item, backward);
        const Index k = 3 * Index(a) + c;
        EXPECT_NEAR(here.residual_n[k], (plus.energy_mj - minus.energy_mj) / (2 * h), 1e-8);
        EXPECT_LT((here.stiffness_n_per_mm.col(k) - (plus.residual_n - minus.residual_n) / (2 * h))
                      .norm(),
                  1e-7 * here.stiffness_n_per_mm.norm());
      }
  }
}

TEST_P(ElementTerms, WithoutStiffnessEnergyAndResidualAreTheSame) {
  const auto mesh = box_mesh({.cells = {1, 1, 1}, .shape = GetParam()});
  const auto terms = make_element_terms(mesh, {{0, kSoft}}).value();
  const Index item = terms[0]->item_count() - 1;
  std::vector<Vec3> x_L;
  for (const std::int32_t node : terms[0]->nodes(item))
    x_L.emplace_back(1.1 * mesh.nodes_L[std::size_t(node)]);
  const LocalResult full = evaluate(*terms[0], item, x_L);
  VectorX residual = VectorX::Zero(full.residual_n.size());
  LocalEquations local{.residual_n = Eigen::Map<VectorX>(residual.data(), residual.size()),
                       .stiffness_n_per_mm = Eigen::Map<Eigen::MatrixXd>(nullptr, 0, 0)};
  ASSERT_TRUE(terms[0]->evaluate(item, x_L, local));
  EXPECT_EQ(local.energy_mj, full.energy_mj);
  EXPECT_EQ(residual, full.residual_n);
}

TEST_P(ElementTerms, AnAffineDeformationStoresVolumeTimesEnergyDensity) {
  const test::Body body(
      box_mesh({.cells = {3, 2, 2}, .size_mm = {2, 3, 4}, .distortion = 0.15, .shape = GetParam()}),
      {{0, kSoft}}, {});
  test::RandomDeformation random(4);
  const Mat3 F = random.gradient();
  const auto forces =
      body.assembler.forces(test::affine(body.mesh, F - Mat3::Identity(), Vec3(1, 2, 3)));
  ASSERT_TRUE(forces.has_value());
  EXPECT_NEAR(forces->energy_mj, 24.0 * kSoft.energy(F), 1e-11 * forces->energy_mj);
}

TEST_P(ElementTerms, ARigidMotionCausesNoForce) {
  const test::Body body(box_mesh({.cells = {3, 2, 2}, .distortion = 0.15, .shape = GetParam()}),
                        {{0, kSoft}}, {});
  test::RandomDeformation random(5);
  for (int n = 0; n < 20; ++n) {
    const auto forces = body.assembler.forces(
        test::affine(body.mesh, random.rotation() - Mat3::Identity(), Vec3(10, -20, 30)));
    ASSERT_TRUE(forces.has_value());
    EXPECT_LT(forces->residual_n.norm(), 1e-12);
    EXPECT_NEAR(forces->energy_mj, 0.0, 1e-12);
  }
}

TEST_P(ElementTerms, AnInvertedElementIsInadmissible) {
  const auto mesh = box_mesh({.cells = {1, 1, 1}, .shape = GetParam()});
  const auto terms = make_element_terms(mesh, {{0, kSoft}}).value();
  std::vector<Vec3> mirrored;
  for (const std::int32_t node : terms[0]->nodes(0))
    mirrored.emplace_back(mesh.nodes_L[std::size_t(node)].cwiseProduct(Vec3(-1, 1, 1)));
  EXPECT_FALSE(evaluate(*terms[0], 0, mirrored).admissible);
  mirrored[0].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(evaluate(*terms[0], 0, mirrored).admissible);
}

TEST_P(ElementTerms, EachRegionHasItsOwnMaterial) {
  auto mesh = box_mesh({.cells = {2, 1, 1}, .shape = GetParam()});
  auto& region = mesh.blocks[0].region;
  std::fill(region.begin() + Index(region.size() / 2), region.end(), 5);  // The half x > 1/2.
  const test::Body body(std::move(mesh), {{5, kStiff}, {0, kSoft}}, {});
  const Mat3 F = Vec3(1.2, 0.9, 1.0).asDiagonal();
  const auto forces =
      body.assembler.forces(test::affine(body.mesh, F - Mat3::Identity(), Vec3::Zero()));
  EXPECT_NEAR(forces->energy_mj, 0.5 * kSoft.energy(F) + 0.5 * kStiff.energy(F), 1e-14);
}

TEST(ElementTerm, TheErrorNamesTheInvertedElementAndItsPosition) {
  auto mesh = box_mesh({.cells = {2, 1, 1}});
  std::swap(mesh.blocks[0].nodes[4 * 7], mesh.blocks[0].nodes[4 * 7 + 1]);
  const auto terms = make_element_terms(mesh, {{0, kSoft}});
  ASSERT_FALSE(terms.has_value());
  EXPECT_EQ(terms.error().code, ErrorCode::kElementInverted);
  // Element 7 runs along y, z, x from (1/2, 0, 0): the mean of its corners is (5/8, 3/4, 1/2).
  EXPECT_EQ(terms.error().message,
            "element 7 at (0.625, 0.750, 0.500) mm is flat or inverted, its volume must be > 0; "
            "its scaled Jacobian is -1");
}

/// A corner beyond the plane of its neighbors: the Jacobian is positive at the quadrature points.
TEST(ElementTerm, TheErrorNamesTheNodeWhereAnElementFolds) {
  auto mesh = box_mesh({.cells = {1, 1, 1}, .size_mm = {2, 2, 2}, .shape = ElementShape::kHex8});
  mesh.nodes_L[7] = Vec3::Constant(1.4);
  EXPECT_TRUE(make_element_terms(mesh, {{0, kSoft}}).has_value());
  mesh.nodes_L[7] = Vec3::Constant(1.2);
  const auto terms = make_element_terms(mesh, {{0, kSoft}});
  ASSERT_FALSE(terms.has_value());
  EXPECT_EQ(terms.error().code, ErrorCode::kElementInverted);
  EXPECT_EQ(terms.error().message,
            "element 0 at (0.900, 0.900, 0.900) mm is folded at its node 6, number 7 of the mesh, "
            "its volume must be > 0 everywhere");
}

/// If a mid-edge node is within a quarter of the edge from its end, the edge turns back there.
TEST(ElementTerm, RejectsAnEdgeThatTurnsBack) {
  for (const ElementShape shape :
       {ElementShape::kTet10, ElementShape::kWedge15, ElementShape::kHex20}) {
    auto mesh = box_mesh({.cells = {1, 1, 1}, .shape = shape});
    mesh.blocks[0].nodes.resize(std::size_t(mesh::node_count(shape)));
    mesh.blocks[0].region.resize(1);
    const std::int32_t* node = mesh.blocks[0].element(0);
    const Vec3 from = mesh.nodes_L[std::size_t(node[0])];
    const Vec3 to = mesh.nodes_L[std::size_t(node[1])];
    Vec3& middle = mesh.nodes_L[std::size_t(node[mesh::corner_count(shape)])];
    middle = from + 0.27 * (to - from);
    EXPECT_TRUE(make_element_terms(mesh, {{0, kSoft}}).has_value());
    middle = from + 0.23 * (to - from);
    EXPECT_EQ(make_element_terms(mesh, {{0, kSoft}}).error().code, ErrorCode::kElementInverted);
  }
}

TEST(ElementTerm, CountsElementsThroughTheBlocks) {
  auto mesh = box_mesh({.cells = {1, 1, 1}});
  mesh.blocks.push_back(mesh.blocks[0]);
  std::swap(mesh.blocks[1].nodes[4], mesh.blocks[1].nodes[5]);
  const auto terms = make_element_terms(mesh, {{0, kSoft}});
  ASSERT_FALSE(terms.has_value());
  EXPECT_EQ(terms.error().message.substr(0, 12), "element 7 at");
}

TEST(ElementTerm, RejectsAFlatElement) {
  auto mesh = box_mesh({.cells = {1, 1, 1}});
  for (Vec3& node : mesh.nodes_L) node.z() *= 1e-15;
  EXPECT_EQ(make_element_terms(mesh, {{0, kSoft}}).error().code, ErrorCode::kElementInverted);
}

TEST(ElementTerm, RejectsAnInconsistentMesh) {
  const auto good = box_mesh({.cells = {1, 1, 1}});
  const auto code_of = [](const mesh::VolumeMesh& mesh) {
    return make_element_terms(mesh, {{0, kSoft}}).error().code;
  };
  auto mesh = good;
  mesh.blocks[0].nodes[5] = 8;
  EXPECT_EQ(code_of(mesh), ErrorCode::kMeshInvalid);
  mesh.blocks[0].nodes[5] = -1;
  EXPECT_EQ(code_of(mesh), ErrorCode::kMeshInvalid);
  mesh = good;
  mesh.blocks[0].nodes.pop_back();
  EXPECT_EQ(code_of(mesh), ErrorCode::kMeshInvalid);
  mesh = good;
  mesh.nodes_L[3].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(code_of(mesh), ErrorCode::kMeshInvalid);
  EXPECT_EQ(code_of({}), ErrorCode::kMeshInvalid);
}

TEST(ElementTerm, RejectsMissingAndInvalidMaterials) {
  const auto mesh = box_mesh({.cells = {1, 1, 1}});
  const auto missing = make_element_terms(mesh, {{1, kSoft}});
  ASSERT_FALSE(missing.has_value());
  EXPECT_EQ(missing.error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(missing.error().message, "region 0 of the volume mesh has no material");
  EXPECT_EQ(make_element_terms(mesh, {{0, NeoHookean{}}}).error().code,
            ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace lefort::fem::test_element_term
