#include <lefort/core/parallel.h>
#include <lefort/linear/block_product.h>
#include <lefort/linear/conjugate_gradients.h>
#include <lefort/linear/multigrid.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "linear/sparse_examples.h"

namespace lefort::linear::test_multigrid {
namespace {

using test::lower_triangle;
using test::random_positive_definite;

VectorX some_vector(Index size, unsigned seed = 11) {
  test::RandomDeformation random(seed);
  return VectorX::NullaryExpr(size, [&] { return random.number(); });
}

/// A stiffness matrix with the point and the axis of each row.
struct Example {
  SparseMatrix A;
  SymmetricBlocks blocks;
  Modes<3> modes;

  explicit Example(const test::Body& body)
      : A(body.assembler.tangent(body.at_rest())), blocks(A), modes(modes_of(body)) {}

  [[nodiscard]] Modes<3> modes_of(const test::Body& body) const {
    std::vector<Vec3> points;
    std::vector<std::int32_t> components;
    for (Index all = 0; all < 3 * body.mesh.node_count(); ++all)
      if (body.assembler.dofs().free_number(all) >= 0) {
        points.push_back(body.mesh.nodes_L[std::size_t(all / 3)]);
        components.push_back(std::int32_t(all % 3));
      }
    return rigid_modes(points, components, blocks);
  }
};

enum class Hold { kFixed, kSliding, kNothing };

Example block(int cells, double poisson, Hold hold = Hold::kFixed,
              mesh::ElementShape shape = mesh::ElementShape::kTet4) {
  auto mesh = test::box_mesh({.cells = {cells, cells, cells}, .shape = shape});
  std::vector<fem::PrescribedDisplacement> held;
  if (hold == Hold::kFixed) held = fem::prescribe_zero(mesh.node_sets.at("x0"));
  if (hold == Hold::kSliding)
    held = test::joined({test::prescribe_component(mesh.node_sets.at("x0"), 0, 0.0),
                         test::prescribe_component(mesh.node_sets.at("y0"), 1, 0.0),
                         test::prescribe_component(mesh.node_sets.at("z0"), 2, 0.0)});
  return Example(test::Body(
      std::move(mesh), {{0, fem::NeoHookean::from_young_poisson(1.0, poisson).value()}}, held));
}

CgOutcome solve(const Example& example, const Multigrid& multigrid, const VectorX& b) {
  return conjugate_gradients(
      [&](const VectorX& x, VectorX& y) { multiply(example.blocks.matrix(), x, y); },
      [&](const VectorX& r, VectorX& z) { z = multigrid.cycle(r); }, b, VectorX::Zero(b.size()),
      1e-8, 200);
}

TEST(SymmetricBlocks, MatchTheMatrixInProducts) {
  for (const Hold hold : {Hold::kFixed, Hold::kSliding}) {
    const Example example = block(4, 0.3, hold);
    const VectorX x = some_vector(example.A.cols());
    VectorX y;
    multiply(example.blocks.matrix(), example.blocks.to_blocks(x), y);
    const VectorX exact = example.A.selfadjointView<Eigen::Lower>() * x;
    EXPECT_LT((example.blocks.from_blocks(y) - exact).norm(), 1e-13 * exact.norm());
  }
}

TEST(SymmetricBlocks, AcceptMatricesOfAnyPattern) {
  for (const Index size : {1, 2, 5, 40}) {
    const Eigen::MatrixXd dense = random_positive_definite(size, 0.2, 1.0, 3);
    const SymmetricBlocks blocks(lower_triangle(dense));
    const VectorX x = some_vector(size);
    VectorX y;
    multiply(blocks.matrix(), blocks.to_blocks(x), y);
    EXPECT_LT((blocks.from_blocks(y) - dense * x).norm(), 1e-13);
  }
}

TEST(BlockProduct, MatchesEigen) {
  const Example example = block(3, 0.3);
  const BlockMatrix<3, 3>& A = example.blocks.matrix();
  const Aggregates aggregates = aggregate(A, 0.02);
  const BlockMatrix<3, 6> P = product(A, coarse_space(aggregates, example.modes).basis);
  const BlockMatrix<6, 6> C = product(transposed(P), P);
  const VectorX x = some_vector(6 * Index(C.columns));
  VectorX direct, inner, outer;
  multiply(C, x, direct);
  multiply(P, x, inner);
  multiply(transposed(P), inner, outer);
  EXPECT_LT((direct - outer).norm(), 1e-12 * outer.norm());
  for (Index i = 0; i < C.rows(); ++i)
    EXPECT_TRUE(std::is_sorted(C.column.begin() + C.row_begin(i), C.column.begin() + C.row_end(i)));
}

TEST(Aggregates, ContainEveryRowAndSeveralRowsEach) {
  const Example example = block(9, 0.3);
  const Aggregates aggregates = aggregate(example.blocks.matrix(), 0.02);
  std::vector<int> size(std::size_t(aggregates.count), 0);
  for (const std::int32_t a : aggregates.of_row) ++size.at(std::size_t(a));
  EXPECT_GT(*std::min_element(size.begin(), size.end()), 0);
  EXPECT_LT(10 * aggregates.count, example.blocks.matrix().rows());
}

TEST(Aggregates, TheCoarseBasisIsOrthonormalAndContainsTheModes) {
  for (const Hold hold : {Hold::kFixed, Hold::kSliding}) {
    const Example example = block(5, 0.3, hold);
    const CoarseSpace<3> space =
        coarse_space(aggregate(example.blocks.matrix(), 0.02), example.modes);
    const BlockMatrix<6, 6> unit = product(transposed(space.basis), space.basis);
    for (Index i = 0; i < unit.rows(); ++i) {
      ASSERT_EQ(unit.row_end(i) - unit.row_begin(i), 1);
      const Eigen::Matrix<double, 6, 6> block = unit.block(unit.row_begin(i));
      for (int c = 0; c < 6; ++c) {
        const bool there = space.modes[std::size_t(i)](c, c) != 0.0;
        EXPECT_NEAR(block(c, c), there ? 1.0 : 0.0, 1e-12);
      }
      EXPECT_LT((block - Eigen::Matrix<double, 6, 6>(block.diagonal().asDiagonal())).norm(), 1e-12);
    }
    for (Index i = 0; i < space.basis.rows(); ++i) {
      const std::int32_t a = space.basis.column[std::size_t(i)];
      EXPECT_LT((space.basis.block(i) * space.modes[std::size_t(a)] - example.modes[std::size_t(i)])
                    .norm(),
                1e-12);
    }
  }
}

TEST(Multigrid, RigidBodyModesAreInTheNullSpaceOfAFreeBody) {
  const Example free = block(4, 0.3, Hold::kNothing);
  for (int c = 0; c < 6; ++c) {
    VectorX mode(3 * Index(free.modes.size())), forces;
    for (std::size_t i = 0; i < free.modes.size(); ++i)
      mode.segment<3>(3 * Index(i)) = free.modes[i].col(c);
    multiply(free.blocks.matrix(), mode, forces);
    EXPECT_LT(forces.norm(), 1e-12 * mode.norm()) << "mode " << c;
  }
}

TEST(Multigrid, IterationsHardlyGrowWithTheMesh) {
  struct Case {
    double poisson;
    mesh::ElementShape shape;
    std::vector<int> cells;
    int maximum;
  };
  for (const Case& c : {Case{0.3, mesh::ElementShape::kTet4, {8, 16, 24}, 22},
                        Case{0.45, mesh::ElementShape::kTet4, {8, 16, 24}, 40},
                        Case{0.3, mesh::ElementShape::kTet10, {4, 8, 12}, 35},
                        Case{0.45, mesh::ElementShape::kTet10, {4, 8, 12}, 60}})
    for (const int cells : c.cells) {
      const Example example = block(cells, c.poisson, Hold::kFixed, c.shape);
      const Multigrid multigrid = *Multigrid::build(example.blocks.matrix(), example.modes);
      EXPECT_LT(multigrid.operator_complexity(), 1.7);
      const VectorX b = example.blocks.to_blocks(some_vector(example.A.cols()));
      const CgOutcome outcome = solve(example, multigrid, b);
      EXPECT_EQ(outcome.stop, CgStop::kConverged);
      EXPECT_LE(outcome.iterations, c.maximum) << cells << " cells, nu " << c.poisson;
      RecordProperty("iterations_" + std::to_string(cells), outcome.iterations);
      VectorX product;
      multiply(example.blocks.matrix(), outcome.x, product);
      EXPECT_LE((product - b).norm(), 1.01e-8 * b.norm());
    }
}

TEST(Multigrid, ACycleIsSymmetricAndPositiveDefinite) {
  const Example example = block(10, 0.45, Hold::kSliding);
  const Multigrid multigrid = *Multigrid::build(example.blocks.matrix(), example.modes);
  EXPECT_GE(multigrid.level_count(), 2);
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const VectorX a = example.blocks.to_blocks(some_vector(example.A.cols(), seed));
    const VectorX b = example.blocks.to_blocks(some_vector(example.A.cols(), 100 + seed));
    const VectorX Ma = multigrid.cycle(a), Mb = multigrid.cycle(b);
    EXPECT_NEAR(a.dot(Mb), b.dot(Ma), 1e-11 * std::abs(a.dot(Ma)));
    EXPECT_GT(a.dot(Ma), 0.0);
  }
}

TEST(Multigrid, BitsDoNotDependOnThreads) {
  const Example example = block(14, 0.3);
  const VectorX b = example.blocks.to_blocks(some_vector(example.A.cols()));
  const auto solved = [&] {
    return solve(example, *Multigrid::build(example.blocks.matrix(), example.modes), b).x;
  };
  const VectorX x = solved();
  for (const int threads : {1, 2, 3}) {
    const ThreadLimit limit(threads);
    EXPECT_EQ(solved(), x);
  }
}

TEST(Multigrid, AcceptsFewOrManyLevels) {
  const Example example = block(12, 0.3);
  const VectorX b = example.blocks.to_blocks(some_vector(example.A.cols()));
  for (const std::int32_t direct_rows : {1, 100, 10000}) {
    const Multigrid multigrid =
        *Multigrid::build(example.blocks.matrix(), example.modes, {.direct_rows = direct_rows});
    EXPECT_EQ(solve(example, multigrid, b).stop, CgStop::kConverged) << multigrid.level_count();
  }
}

TEST(Multigrid, DetectsAnIndefiniteMatrix) {
  Example example = block(8, 0.3);
  const auto set = [&](const SparseMatrix& A) {
    example.blocks.set_values({A.valuePtr(), std::size_t(A.nonZeros())});
  };
  SparseMatrix A = example.A;
  A.coeffRef(300, 300) = -1.0;  // In a diagonal block.
  set(A);
  const auto refused = Multigrid::build(example.blocks.matrix(), example.modes);
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error(), LinearSolveStatus::kNotPositiveDefinite);
  A = example.A;
  A.diagonal() *= 0.6;  // Only the whole matrix is indefinite.
  set(A);
  const auto multigrid = Multigrid::build(example.blocks.matrix(), example.modes);
  if (multigrid) {
    const VectorX b = example.blocks.to_blocks(some_vector(A.cols()));
    EXPECT_EQ(solve(example, *multigrid, b).stop, CgStop::kNotPositiveDefinite);
  }
}

TEST(ConjugateGradients, ConvergeInAsManyIterationsAsUnknowns) {
  const Eigen::MatrixXd A = random_positive_definite(12, 0.5, 0.5, 2);
  const VectorX b = some_vector(12);
  const auto outcome = conjugate_gradients([&](const VectorX& x, VectorX& y) { y = A * x; },
                                           [](const VectorX& r, VectorX& z) { z = r; }, b,
                                           VectorX::Zero(12), 1e-10, 13);
  EXPECT_EQ(outcome.stop, CgStop::kConverged);
  EXPECT_LT((A * outcome.x - b).norm(), 1.1e-10 * b.norm());
  const auto too_few = conjugate_gradients([&](const VectorX& x, VectorX& y) { y = A * x; },
                                           [](const VectorX& r, VectorX& z) { z = r; }, b,
                                           VectorX::Zero(12), 1e-10, 3);
  EXPECT_EQ(too_few.stop, CgStop::kTooManyIterations);
  EXPECT_EQ(too_few.iterations, 3);
}

TEST(ConjugateGradients, AZeroRightSideGivesZero) {
  const auto outcome = conjugate_gradients([](const VectorX& x, VectorX& y) { y = x; },
                                           [](const VectorX& r, VectorX& z) { z = r; },
                                           VectorX::Zero(5), VectorX::Zero(5), 1e-8, 10);
  EXPECT_EQ(outcome.stop, CgStop::kConverged);
  EXPECT_EQ(outcome.iterations, 0);
}

}  // namespace
}  // namespace lefort::linear::test_multigrid
