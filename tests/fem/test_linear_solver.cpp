#include <lefort/core/check.h>
#include <lefort/fem/linear_solver.h>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <limits>
#include <utility>

#include "fem/little_memory.h"
#include "fem/random_deformation.h"

namespace lefort::fem {
namespace {

constexpr Index kSize = 60;

/// Symmetric positive definite with about 15 % of its entries.
Eigen::MatrixXd example(unsigned seed) {
  test::RandomDeformation random(seed);
  Eigen::MatrixXd B = Eigen::MatrixXd::Zero(kSize, kSize);
  for (Index i = 0; i < kSize; ++i)
    for (Index j = 0; j < kSize; ++j)
      if (std::abs(random.number()) < 0.04) B(i, j) = random.number();
  return B * B.transpose() + 0.1 * Eigen::MatrixXd::Identity(kSize, kSize);
}

SparseMatrix lower(const Eigen::MatrixXd& A) {
  SparseMatrix L = Eigen::MatrixXd(A.triangularView<Eigen::Lower>()).sparseView();
  L.makeCompressed();
  return L;
}

VectorX right_side() { return VectorX::LinSpaced(kSize, -1.0, 2.0); }

TEST(LinearSolver, SolvesLikeADenseFactorisation) {
  const Eigen::MatrixXd A = example(1);
  LinearSolver solver;
  ASSERT_EQ(solver.factorise(lower(A)), Factorisation::kDone);
  EXPECT_GT(solver.factor_entries(), double(kSize));
  const VectorX x = A.llt().solve(right_side());
  EXPECT_LT((*solver.solve(right_side()) - x).norm(), 1e-11 * x.norm());
}

TEST(LinearSolver, TakesNewValuesAndNewPatterns) {
  LinearSolver solver;
  for (const unsigned seed : {1U, 2U, 3U}) {
    const Eigen::MatrixXd A = example(seed);
    for (const double factor : {1.0, 2.0}) {
      ASSERT_EQ(solver.factorise(lower(factor * A)), Factorisation::kDone);
      EXPECT_LT((factor * A * *solver.solve(right_side()) - right_side()).norm(), 1e-10);
    }
  }
}

TEST(LinearSolver, SaysWhenTheMatrixIsNotPositiveDefinite) {
  const Eigen::MatrixXd A = example(1) - 1.0 * Eigen::MatrixXd::Identity(kSize, kSize);
  LinearSolver solver;
  ASSERT_EQ(solver.factorise(lower(A)), Factorisation::kNotPositiveDefinite);
  EXPECT_THROW((void)solver.solve(right_side()), LogicError);
  const Eigen::MatrixXd shifted = A + 2.0 * Eigen::MatrixXd::Identity(kSize, kSize);
  ASSERT_EQ(solver.factorise(lower(shifted)), Factorisation::kDone);
  EXPECT_LT((shifted * *solver.solve(right_side()) - right_side()).norm(), 1e-10);
}

TEST(LinearSolver, ASingularMatrixIsNotPositiveDefinite) {
  Eigen::MatrixXd A = example(1);
  A.row(7).setZero();
  A.col(7).setZero();
  SparseMatrix sparse = lower(A);
  sparse.coeffRef(7, 7) = 0.0;
  sparse.makeCompressed();
  LinearSolver solver;
  EXPECT_EQ(solver.factorise(sparse), Factorisation::kNotPositiveDefinite);
  sparse.coeffRef(7, 7) = 1e-18;  // Positive, but nothing beside the others.
  EXPECT_EQ(solver.factorise(sparse), Factorisation::kNotPositiveDefinite);
}

TEST(LinearSolver, RefusesNaN) {
  Eigen::MatrixXd A = example(1);
  A(5, 5) = std::numeric_limits<double>::quiet_NaN();
  LinearSolver solver;
  EXPECT_EQ(solver.factorise(lower(A)), Factorisation::kNotFinite);
}

TEST(LinearSolver, AWrongCallIsABug) {
  LinearSolver solver;
  EXPECT_EQ(solver.factor_entries(), 0.0);
  EXPECT_THROW((void)solver.solve(right_side()), LogicError);
  EXPECT_THROW((void)solver.factorise(SparseMatrix(2, 3)), LogicError);
}

TEST(LinearSolver, SaysWhenMemoryRunsOut) {
  LinearSolver solver;
  {
    const test::LittleMemory little;
    EXPECT_EQ(solver.factorise(lower(example(1))), Factorisation::kOutOfMemory);
  }
  ASSERT_EQ(solver.factorise(lower(example(1))), Factorisation::kDone);
  {
    const test::LittleMemory little;
    EXPECT_FALSE(solver.solve(right_side()).has_value());
    EXPECT_EQ(solver.factorise(lower(example(2))), Factorisation::kOutOfMemory);
  }
  EXPECT_EQ(solver.factorise(lower(example(2))), Factorisation::kDone);
}

TEST(LinearSolver, CanBeMoved) {
  LinearSolver first;
  ASSERT_EQ(first.factorise(lower(example(1))), Factorisation::kDone);
  const VectorX x = first.solve(right_side()).value();
  const LinearSolver second = std::move(first);
  EXPECT_EQ(second.solve(right_side()).value(), x);
}

}  // namespace
}  // namespace lefort::fem
