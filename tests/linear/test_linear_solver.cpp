#include <lefort/core/check.h>
#include <lefort/linear/linear_solver.h>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <limits>
#include <utility>

#include "linear/little_memory.h"
#include "linear/sparse_examples.h"

namespace lefort::linear::test_linear_solver {
namespace {

constexpr Index kSize = 60;

Eigen::MatrixXd example(unsigned seed) {
  return test::random_positive_definite(kSize, 0.04, 0.1, seed);
}

SparseMatrix lower(const Eigen::MatrixXd& A) { return test::lower_triangle(A); }

VectorX right_side() { return VectorX::LinSpaced(kSize, -1.0, 2.0); }

TEST(LinearSolver, MatchesADenseFactorization) {
  const Eigen::MatrixXd A = example(1);
  LinearSolver solver;
  ASSERT_EQ(solver.factorize(lower(A)), LinearSolveStatus::kDone);
  EXPECT_GT(solver.statistics().factor_entries, double(kSize));
  const VectorX x = A.llt().solve(right_side());
  EXPECT_LT((*solver.solve(right_side()) - x).norm(), 1e-11 * x.norm());
}

TEST(LinearSolver, AcceptsNewValuesAndNewPatterns) {
  LinearSolver solver;
  for (const unsigned seed : {1U, 2U, 3U}) {
    const Eigen::MatrixXd A = example(seed);
    for (const double factor : {1.0, 2.0}) {
      ASSERT_EQ(solver.factorize(lower(factor * A)), LinearSolveStatus::kDone);
      EXPECT_LT((factor * A * *solver.solve(right_side()) - right_side()).norm(), 1e-10);
    }
  }
}

TEST(LinearSolver, ReportsWhenTheMatrixIsNotPositiveDefinite) {
  const Eigen::MatrixXd A = example(1) - 1.0 * Eigen::MatrixXd::Identity(kSize, kSize);
  LinearSolver solver;
  ASSERT_EQ(solver.factorize(lower(A)), LinearSolveStatus::kNotPositiveDefinite);
  EXPECT_THROW((void)solver.solve(right_side()), LogicError);
  const Eigen::MatrixXd shifted = A + 2.0 * Eigen::MatrixXd::Identity(kSize, kSize);
  ASSERT_EQ(solver.factorize(lower(shifted)), LinearSolveStatus::kDone);
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
  EXPECT_EQ(solver.factorize(sparse), LinearSolveStatus::kNotPositiveDefinite);
  sparse.coeffRef(7, 7) = 1e-18;  // Positive, but negligible next to the others.
  EXPECT_EQ(solver.factorize(sparse), LinearSolveStatus::kNotPositiveDefinite);
}

TEST(LinearSolver, RejectsNaN) {
  Eigen::MatrixXd A = example(1);
  A(5, 5) = std::numeric_limits<double>::quiet_NaN();
  LinearSolver solver;
  EXPECT_EQ(solver.factorize(lower(A)), LinearSolveStatus::kNotFinite);
}

TEST(LinearSolver, InvalidCallsThrowLogicErrors) {
  LinearSolver solver;
  EXPECT_EQ(solver.statistics().factor_entries, 0.0);
  EXPECT_THROW((void)solver.solve(right_side()), LogicError);
  EXPECT_THROW((void)solver.factorize(SparseMatrix(2, 3)), LogicError);
}

TEST(LinearSolver, ReportsExhaustedMemory) {
  LinearSolver solver(test::little_memory());
  EXPECT_EQ(solver.factorize(lower(example(1))), LinearSolveStatus::kOutOfMemory);
  EXPECT_THROW((void)solver.solve(right_side()), LogicError);
}

TEST(LinearSolver, CanBeMoved) {
  LinearSolver first;
  ASSERT_EQ(first.factorize(lower(example(1))), LinearSolveStatus::kDone);
  const VectorX x = first.solve(right_side()).value();
  LinearSolver second = std::move(first);
  EXPECT_EQ(second.solve(right_side()).value(), x);
}

/// A cube of soft tissue and its tangents, in the reference configuration and stretched by a
/// fraction of its length.
class Cube {
 public:
  explicit Cube(int cells, double poisson = 0.45) : body_(make_body(cells, poisson)) {}

  [[nodiscard]] SparseMatrix tangent(double stretch) const {
    Mat3 gradient = Mat3::Zero();
    gradient(0, 0) = stretch;
    return body_.assembler.tangent(test::affine(body_.mesh, gradient, Vec3::Zero()));
  }
  [[nodiscard]] LinearSolver solver(LinearSolverOptions options) const {
    LinearSolver made(options);
    fem::set_near_null_space(made, body_.assembler);
    return made;
  }

 private:
  static test::Body make_body(int cells, double poisson) {
    mesh::VolumeMesh mesh = test::box_mesh({.cells = {cells, cells, cells}});
    auto held = fem::prescribe_zero(mesh.node_sets.at("x0"));
    return {std::move(mesh),
            {{0, fem::NeoHookean::from_young_poisson(1.0, poisson).value()}},
            std::move(held)};
  }
  test::Body body_;
};

constexpr LinearSolverOptions kReusedFactor{.kind = LinearSolverKind::kReusedFactor};
constexpr LinearSolverOptions kMultigrid{.kind = LinearSolverKind::kMultigrid};

VectorX some_forces(Index size) {
  test::RandomDeformation random(11);
  return VectorX::NullaryExpr(size, [&] { return random.number(); });
}

TEST(LinearSolver, AllKindsGiveTheSameSolution) {
  const Cube cube(12);
  LinearSolver direct = cube.solver({.kind = LinearSolverKind::kDirect});
  LinearSolver lagged = cube.solver(kReusedFactor), multigrid = cube.solver(kMultigrid);
  for (const double stretch : {0.0, 0.02, 0.04}) {
    const SparseMatrix A = cube.tangent(stretch);
    const VectorX b = some_forces(A.cols());
    const VectorX x = direct.solve(A, b).value();
    EXPECT_LT((lagged.solve(A, b, 1e-10).value() - x).norm(), 1e-7 * x.norm());
    EXPECT_LT((multigrid.solve(A, b, 1e-10).value() - x).norm(), 1e-7 * x.norm());
    for (LinearSolver* const solver : {&lagged, &multigrid}) {
      const VectorX y = solver->solve(A, b, 1e-6).value();
      EXPECT_LE((A.selfadjointView<Eigen::Lower>() * y - b).norm(), 1.01e-6 * b.norm());
    }
  }
  EXPECT_EQ(multigrid.kind(), LinearSolverKind::kMultigrid);
  EXPECT_EQ(multigrid.statistics().analyses, 1);
  EXPECT_GT(multigrid.statistics().iterations, 0);
}

/// A very different matrix: S A S, with every other row scaled by ten.
SparseMatrix unevenly_scaled(SparseMatrix A) {
  for (Index j = 0; j < A.cols(); ++j)
    for (SparseMatrix::InnerIterator entry(A, j); entry; ++entry)
      entry.valueRef() *= (entry.row() % 2 == 0 ? 10.0 : 1.0) * (j % 2 == 0 ? 10.0 : 1.0);
  return A;
}

TEST(LinearSolver, ReusesAFactorWhileItConvergesFast) {
  const Cube cube(10);
  LinearSolver solver = cube.solver(kReusedFactor);
  const VectorX b = some_forces(cube.tangent(0.0).cols());
  ASSERT_TRUE(solver.solve(cube.tangent(0.0), b).has_value());
  EXPECT_EQ(solver.statistics().iterations, 0);  // Its own factor needs no iterations.
  ASSERT_TRUE(solver.solve(cube.tangent(0.01), b, 1e-4).has_value());
  EXPECT_EQ(solver.statistics().factorizations, 1);
  EXPECT_GT(solver.statistics().iterations, 0);
  // Finally the factor is recomputed.
  const SparseMatrix far = unevenly_scaled(cube.tangent(0.0));
  const auto x = solver.solve(far, b);
  ASSERT_TRUE(x.has_value());
  EXPECT_LT((far.selfadjointView<Eigen::Lower>() * *x - b).norm(), 1e-9 * b.norm());
  EXPECT_EQ(solver.statistics().factorizations, 2);
}

TEST(LinearSolver, ReusesAHierarchyWhileItConvergesFast) {
  const Cube cube(12);
  LinearSolver solver = cube.solver(kMultigrid);
  const VectorX b = some_forces(cube.tangent(0.0).cols());
  const auto residual = [&](const SparseMatrix& A) {
    const auto x = solver.solve(A, b, 1e-8);
    return x ? (A.selfadjointView<Eigen::Lower>() * *x - b).norm() / b.norm() : 1.0;
  };
  EXPECT_LT(residual(cube.tangent(0.0)), 1.01e-8);
  const int iterations = solver.statistics().iterations;
  for (const double stretch : {0.02, 0.04, 0.06})
    EXPECT_LT(residual(cube.tangent(stretch)), 1.01e-8);
  EXPECT_EQ(solver.statistics().factorizations, 1);
  EXPECT_LT(solver.statistics().iterations, 5 * iterations);
  // For a very different matrix the old hierarchy converges slowly, so the next solve rebuilds it.
  const SparseMatrix far = unevenly_scaled(cube.tangent(0.0));
  EXPECT_LT(residual(far), 1.01e-8);
  EXPECT_LT(residual(far), 1.01e-8);
  EXPECT_EQ(solver.statistics().factorizations, 2);
}

TEST(LinearSolver, IterationsDetectIndefiniteMatrices) {
  const Cube cube(10);
  const SparseMatrix A = cube.tangent(0.0);
  SparseMatrix indefinite = A;
  indefinite.diagonal() *= 0.5;
  const VectorX b = some_forces(A.cols());
  for (const LinearSolverOptions& options : {kReusedFactor, kMultigrid}) {
    LinearSolver solver = cube.solver(options);
    ASSERT_TRUE(solver.solve(A, b).has_value());
    const auto refused = solver.solve(indefinite, b);
    ASSERT_FALSE(refused.has_value());
    EXPECT_EQ(refused.error(), LinearSolveStatus::kNotPositiveDefinite);
    EXPECT_TRUE(solver.solve(A, b).has_value());
  }
}

TEST(LinearSolver, AutomaticIsDirectForSmallSystemsOrWithoutNearNullSpace) {
  const Cube cube(12);
  const SparseMatrix A = cube.tangent(0.0);
  const auto kind_of = [&](LinearSolver solver) {
    EXPECT_EQ(solver.factorize(A), LinearSolveStatus::kDone);
    return solver.kind();
  };
  EXPECT_EQ(kind_of(cube.solver({})), LinearSolverKind::kDirect);
  EXPECT_EQ(kind_of(cube.solver({.direct_rows = 5000})), LinearSolverKind::kMultigrid);
  EXPECT_EQ(kind_of(LinearSolver({.direct_rows = 5000})), LinearSolverKind::kDirect);
}

TEST(LinearSolver, AutomaticSolvesDirectlyIfMultigridFails) {
  const Cube cube(12);
  const SparseMatrix A = cube.tangent(0.0);
  const VectorX b = some_forces(A.cols());
  LinearSolver patient = cube.solver({.direct_rows = 5000, .max_iterations = 2});
  ASSERT_EQ(patient.factorize(A), LinearSolveStatus::kDone);
  const auto gave_up = patient.solve(b);
  ASSERT_FALSE(gave_up.has_value());
  EXPECT_EQ(gave_up.error(), LinearSolveStatus::kNotConverged);
  LinearSolver solver = cube.solver({.direct_rows = 5000, .max_iterations = 2});
  const auto x = solver.solve(A, b);
  ASSERT_TRUE(x.has_value());
  EXPECT_LT((A.selfadjointView<Eigen::Lower>() * *x - b).norm(), 1e-10 * b.norm());
  EXPECT_EQ(solver.kind(), LinearSolverKind::kDirect);
}

TEST(LinearSolver, AllKindsAcceptMatricesOfSizeZeroAndOne) {
  for (const auto kind :
       {LinearSolverKind::kAutomatic, LinearSolverKind::kDirect, LinearSolverKind::kReusedFactor}) {
    LinearSolver solver({.kind = kind});
    EXPECT_EQ(solver.solve(SparseMatrix(0, 0), VectorX(0)).value().size(), 0);
    const Eigen::MatrixXd four = Eigen::MatrixXd::Constant(1, 1, 4.0);
    EXPECT_EQ(solver.solve(lower(four), VectorX::Ones(1)).value()[0], 0.25);
    EXPECT_EQ(solver.solve(lower(-four), VectorX::Ones(1)).has_value(), false);
  }
}

}  // namespace
}  // namespace lefort::linear::test_linear_solver
