#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/fem/assembly/assemble.h>

#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <limits>
#include <string>

#include "fem/body.h"
#include "fem/random_deformation.h"
#include "support/box_mesh.h"

namespace lefort::fem::test_assemble {
namespace {

using test::box_mesh;

constexpr NeoHookean kLaw{.mu_mpa = 0.5, .lambda_mpa = 2.0};

/// Springs W = k/2 |x_b - x_a|^2 between given pairs of nodes, of one element or not.
class Springs final : public ForceTerm {
 public:
  explicit Springs(std::vector<std::array<std::int32_t, 2>> pairs) : pairs_(std::move(pairs)) {}
  Index item_count() const override { return Index(pairs_.size()); }
  std::span<const std::int32_t> nodes(Index item) const override {
    return pairs_[std::size_t(item)];
  }
  bool evaluate(Index, std::span<const Vec3> x_L, LocalEquations& local) const override {
    const Vec3 d = x_L[1] - x_L[0];
    local.energy_mj = 0.5 * kStiffness * d.squaredNorm();
    local.residual_n.head<3>() = -kStiffness * d;
    local.residual_n.tail<3>() = kStiffness * d;
    if (local.wants_stiffness()) {
      const Mat3 K = kStiffness * Mat3::Identity();
      local.stiffness_n_per_mm << K, -K, -K, K;
    }
    return true;
  }

 private:
  static constexpr double kStiffness = 0.3;
  std::vector<std::array<std::int32_t, 2>> pairs_;
};

/// A distorted, deformed box with some components prescribed and springs across it: 3,072 elements,
/// so that several chunks add to the same entries.
class Assembly : public testing::Test {
 protected:
  static mesh::VolumeMesh make_mesh() {
    return box_mesh({.cells = {8, 8, 8}, .size_mm = {8, 8, 8}, .distortion = 0.15});
  }
  static std::vector<PrescribedDisplacement> conditions(const mesh::VolumeMesh& mesh) {
    return test::joined({test::prescribe_component(mesh.node_sets.at("x0"), 0, 0.0),
                         test::prescribe_component(mesh.node_sets.at("y0"), 1, 0.0),
                         prescribe_zero(mesh.node_sets.at("z1")),
                         {{.node = 400, .component = 1, .displacement_mm = 0.1}}});
  }
  VectorX deformed() const {
    test::RandomDeformation random(6);
    VectorX u = test::affine(body_.mesh, 0.2 * random.matrix(), Vec3(1, 2, 3));
    for (Index i = 0; i < u.size(); ++i) u[i] += 0.02 * random.number();
    return u;
  }

  Springs springs_{{{0, 728}, {728, 3}, {5, 300}, {0, 728}}};
  test::Body body_{make_mesh(), {{0, kLaw}}, conditions(make_mesh()), {&springs_}};
};

/// Reference results: dense sums over items in plain loops.
struct DenseSums {
  double energy_mj = 0.0;
  VectorX residual_n;
  Eigen::MatrixXd tangent_n_per_mm;
};

DenseSums dense_sums(const std::vector<Vec3>& nodes_L, const std::vector<const ForceTerm*>& terms,
                     const VectorX& u) {
  const Index size = u.size();
  DenseSums sums{.residual_n = VectorX::Zero(size),
                 .tangent_n_per_mm = Eigen::MatrixXd::Zero(size, size)};
  for (const ForceTerm* term : terms)
    for (Index item = 0; item < term->item_count(); ++item) {
      const auto nodes = term->nodes(item);
      const Index n = Index(nodes.size());
      std::vector<Vec3> x_L;
      for (const auto node : nodes)
        x_L.emplace_back(nodes_L[std::size_t(node)] + u.segment<3>(3 * Index(node)));
      VectorX r = VectorX::Zero(3 * n);
      Eigen::MatrixXd K = Eigen::MatrixXd::Zero(3 * n, 3 * n);
      LocalEquations local{
          .residual_n = Eigen::Map<VectorX>(r.data(), 3 * n),
          .stiffness_n_per_mm = Eigen::Map<Eigen::MatrixXd>(K.data(), 3 * n, 3 * n)};
      EXPECT_TRUE(term->evaluate(item, x_L, local));
      sums.energy_mj += local.energy_mj;
      for (Index a = 0; a < n; ++a) {
        const Index A = 3 * Index(nodes[std::size_t(a)]);
        sums.residual_n.segment<3>(A) += r.segment<3>(3 * a);
        for (Index b = 0; b < n; ++b)
          sums.tangent_n_per_mm.block<3, 3>(A, 3 * Index(nodes[std::size_t(b)])) +=
              K.block<3, 3>(3 * a, 3 * b);
      }
    }
  return sums;
}

TEST_F(Assembly, NamesTheInvertedElementAndItsPosition) {
  VectorX u = body_.at_rest();
  EXPECT_EQ(body_.assembler.inadmissible_cause(u), "");
  const std::int32_t corner = 0;  // Through the opposite side of its element.
  u.segment<3>(3 * Index(corner)) = Vec3(2.0, 2.0, 2.0);
  ASSERT_FALSE(body_.assembler.forces(u));
  const std::string cause = body_.assembler.inadmissible_cause(u);
  EXPECT_EQ(cause.find("an element is inverted at ("), 0U) << cause;
  double x = 1e9, y = 1e9, z = 1e9;
  ASSERT_EQ(std::sscanf(cause.c_str(), "an element is inverted at (%lf, %lf, %lf) mm", &x, &y, &z),
            3)
      << cause;
  EXPECT_LT(Vec3(x, y, z).norm(), 3.6);  // Within the elements at the corner.
  u[7] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(body_.assembler.inadmissible_cause(u), "a displacement is not finite");
}

TEST_F(Assembly, EqualsPlainSumsOverAllItems) {
  const VectorX u = deformed();
  const DenseSums expected = dense_sums(body_.mesh.nodes_L, {body_.terms[0].get(), &springs_}, u);
  const auto forces = body_.assembler.forces(u);
  ASSERT_TRUE(forces.has_value());
  EXPECT_NEAR(forces->energy_mj, expected.energy_mj, 1e-11 * expected.energy_mj);
  EXPECT_LT((forces->residual_n - expected.residual_n).norm(),
            1e-12 * forces->residual_reference_n);

  const linear::SparseMatrix K = body_.assembler.tangent(u);
  const DofMap& dofs = body_.assembler.dofs();
  ASSERT_EQ(K.rows(), dofs.free_count());
  Eigen::MatrixXd free(K.rows(), K.cols());
  for (Index column = 0; column < u.size(); ++column) {
    const Index j = dofs.free_number(column);
    if (j >= 0) free.col(j) = dofs.free_part(expected.tangent_n_per_mm.col(column));
  }
  const Eigen::MatrixXd lower = free.triangularView<Eigen::Lower>();
  EXPECT_LT((Eigen::MatrixXd(K) - lower).norm(), 1e-13 * lower.norm());
}

TEST_F(Assembly, TangentIsTheDerivativeOfTheResidual) {
  const VectorX u = deformed();
  const DofMap& dofs = body_.assembler.dofs();
  const linear::SparseMatrix K = body_.assembler.tangent(u);
  test::RandomDeformation random(8);
  VectorX direction(dofs.free_count());
  for (Index i = 0; i < direction.size(); ++i) direction[i] = random.number();
  const double h = 1e-6;
  const VectorX du = dofs.with_free_part(VectorX::Zero(u.size()), h * direction);
  const VectorX difference = dofs.free_part(body_.assembler.forces(u + du)->residual_n -
                                            body_.assembler.forces(u - du)->residual_n) /
                             (2 * h);
  const VectorX product = K.selfadjointView<Eigen::Lower>() * direction;
  EXPECT_LT((product - difference).norm(), 1e-8 * difference.norm());
}

TEST_F(Assembly, ResidualIsTheDerivativeOfTheEnergy) {
  const VectorX u = deformed();
  test::RandomDeformation random(9);
  VectorX du(u.size());
  for (Index i = 0; i < du.size(); ++i) du[i] = 1e-5 * random.number();
  const double difference =
      (body_.assembler.forces(u + du)->energy_mj - body_.assembler.forces(u - du)->energy_mj) / 2;
  const double product = body_.assembler.forces(u)->residual_n.dot(du);
  EXPECT_NEAR(product, difference, 1e-7 * std::abs(product));
}

TEST_F(Assembly, TangentTimesCouplesFreeAndPrescribedComponents) {
  const VectorX u = deformed();
  const DenseSums expected = dense_sums(body_.mesh.nodes_L, {body_.terms[0].get(), &springs_}, u);
  VectorX du = VectorX::Zero(u.size());
  for (const auto node : body_.mesh.node_sets.at("z1")) du[3 * Index(node) + 2] = 0.1;
  const VectorX product = expected.tangent_n_per_mm * du;
  EXPECT_LT((body_.assembler.tangent_times(u, du) - product).norm(), 1e-13 * product.norm());
  EXPECT_GT(body_.assembler.dofs().free_part(product).norm(), 0.1);
}

TEST_F(Assembly, SameBitsForAnyNumberOfThreads) {
  const VectorX u = deformed();
  const auto with_threads = [&](int threads) {
    const ThreadLimit limit(threads);
    const auto forces = body_.assembler.forces(u).value();
    const linear::SparseMatrix K = body_.assembler.tangent(u);
    VectorX all(2 + forces.residual_n.size() + K.nonZeros() + u.size());
    all << forces.energy_mj, forces.residual_reference_n, forces.residual_n,
        Eigen::Map<const VectorX>(K.valuePtr(), K.nonZeros()), body_.assembler.tangent_times(u, u);
    return all;
  };
  const VectorX one = with_threads(1);
  EXPECT_EQ(one, with_threads(2));
  EXPECT_EQ(one, with_threads(3));
}

TEST_F(Assembly, PatternIsLowerSortedAndTheSameEverywhere) {
  const linear::SparseMatrix at_rest = body_.assembler.tangent(body_.at_rest());
  const linear::SparseMatrix deformed_tangent = body_.assembler.tangent(deformed());
  ASSERT_EQ(at_rest.nonZeros(), deformed_tangent.nonZeros());
  for (Index j = 0; j < at_rest.cols(); ++j) {
    Index previous = j - 1;
    linear::SparseMatrix::InnerIterator b(deformed_tangent, j);
    for (linear::SparseMatrix::InnerIterator a(at_rest, j); a; ++a, ++b) {
      EXPECT_GT(a.row(), previous);
      EXPECT_EQ(a.row(), b.row());
      previous = a.row();
    }
    EXPECT_EQ(linear::SparseMatrix::InnerIterator(at_rest, j).row(),
              j);  // The first entry is the diagonal.
  }
}

TEST_F(Assembly, OneInvertedOrNonFiniteElementMakesTheStateInadmissible) {
  VectorX u = body_.at_rest();
  u[3 * 364] = 3.0;  // Beyond its neighbors.
  EXPECT_FALSE(body_.assembler.forces(u).has_value());
  u[3 * 364] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(body_.assembler.forces(u).has_value());
  u[3 * 364] = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(body_.assembler.forces(u).has_value());
  EXPECT_THROW((void)body_.assembler.tangent(u), LogicError);
}

TEST_F(Assembly, TheResidualReferenceIsTheSizeOfTheForcesThatCancel) {
  // Under a uniform stretch all interior forces cancel; their magnitudes do not.
  const test::Body body(make_mesh(), {{0, kLaw}},
                        prescribe_zero(make_mesh().node_sets.at("outside")));
  const auto forces =
      body.assembler.forces(test::affine(body.mesh, 0.1 * Mat3::Identity(), Vec3::Zero()));
  EXPECT_LT(body.assembler.dofs().free_part(forces->residual_n).norm(),
            1e-14 * forces->residual_reference_n);
  EXPECT_GT(forces->residual_reference_n, 1.0);
  EXPECT_NEAR(body.assembler.forces(body.at_rest())->residual_reference_n, 0.0, 1e-12);
}

TEST(Assembler, NodesWithoutItemsHaveADiagonal) {
  const Assembler assembler(std::vector<Vec3>(2, Vec3::Zero()), DofMap::build(2, {}).value(), {});
  const linear::SparseMatrix K = assembler.tangent(VectorX::Zero(6));
  EXPECT_EQ(K.rows(), 6);
  EXPECT_EQ(K.coeff(5, 5), 0.0);
  EXPECT_EQ(assembler.forces(VectorX::Zero(6))->residual_n.norm(), 0.0);
}

TEST(Assembler, AnItemWithADuplicateOrMissingNodeIsALogicError) {
  const auto assemble = [](std::array<std::int32_t, 2> pair) {
    const Springs springs({pair});
    const Assembler assembler(std::vector<Vec3>(2, Vec3::Zero()), DofMap::build(2, {}).value(),
                              {&springs});
  };
  EXPECT_NO_THROW(assemble({0, 1}));
  EXPECT_THROW(assemble({1, 1}), LogicError);
  EXPECT_THROW(assemble({0, 2}), LogicError);
}

}  // namespace
}  // namespace lefort::fem::test_assemble
