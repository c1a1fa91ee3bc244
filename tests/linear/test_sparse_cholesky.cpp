#include <lefort/core/parallel.h>
#include <lefort/linear/pattern_graph.h>
#include <lefort/linear/sparse_cholesky.h>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>
#include <suitesparse/cholmod.h>

#include <algorithm>
#include <numeric>
#include <set>
#include <span>
#include <thread>
#include <utility>
#include <vector>

#include "linear/sparse_examples.h"

namespace lefort::linear::test_sparse_cholesky {
namespace {

using test::block_stiffness;
using test::lower_triangle;
using test::random_positive_definite;

constexpr std::int64_t kPlenty = std::int64_t(1) << 32;

std::span<const double> values(const SparseMatrix& A) {
  return {A.valuePtr(), std::size_t(A.nonZeros())};
}

SparseCholesky factor_of(const SparseMatrix& A, TileSimd simd = best_tile_simd()) {
  SparseCholesky cholesky(plan_cholesky(A).value(), kPlenty, simd);
  EXPECT_EQ(cholesky.factorize(values(A)), LinearSolveStatus::kDone);
  return cholesky;
}

VectorX some_vector(Index size) {
  test::RandomDeformation random(11);
  return VectorX::NullaryExpr(size, [&] { return random.number(); });
}

/// The same with CHOLMOD.
VectorX solved_by_cholmod(const SparseMatrix& A, VectorX b) {
  cholmod_common common;
  cholmod_start(&common);
  common.supernodal = CHOLMOD_SIMPLICIAL;  // Single-threaded.
  cholmod_sparse matrix{};
  matrix.nrow = matrix.ncol = std::size_t(A.cols());
  matrix.nzmax = std::size_t(A.nonZeros());
  matrix.p = const_cast<int*>(A.outerIndexPtr());
  matrix.i = const_cast<int*>(A.innerIndexPtr());
  matrix.x = const_cast<double*>(A.valuePtr());
  matrix.stype = -1;
  matrix.itype = CHOLMOD_INT;
  matrix.xtype = CHOLMOD_REAL;
  matrix.sorted = matrix.packed = 1;
  cholmod_factor* factor = cholmod_analyze(&matrix, &common);
  cholmod_factorize(&matrix, factor, &common);
  cholmod_dense right{};
  right.nrow = right.d = right.nzmax = std::size_t(b.size());
  right.ncol = 1;
  right.x = b.data();
  right.xtype = CHOLMOD_REAL;
  cholmod_dense* solution = cholmod_solve(CHOLMOD_A, factor, &right, &common);
  VectorX x = Eigen::Map<const VectorX>(static_cast<const double*>(solution->x), b.size());
  cholmod_free_dense(&solution, &common);
  cholmod_free_factor(&factor, &common);
  cholmod_finish(&common);
  return x;
}

TEST(PatternGraph, RowsOfOnePatternAreOneVertex) {
  // Rows 0 to 2 and 3 to 4 are coupled nodes; 5 is isolated, and 6 is coupled with one row of a
  // node.
  Eigen::MatrixXd A = Eigen::MatrixXd::Identity(7, 7);
  A.topLeftCorner(5, 5).setOnes();
  A(6, 4) = 1.0;
  const PatternGraph graph = pattern_graph(lower_triangle(A));
  EXPECT_EQ(graph.first_row, (std::vector<std::int32_t>{0, 4, 5, 6, 7}));
  EXPECT_EQ(graph.start, (std::vector<std::int32_t>{0, 1, 3, 3, 4}));
  EXPECT_EQ(graph.neighbor, (std::vector<std::int32_t>{1, 0, 3, 1}));
}

TEST(PatternGraph, OfAMeshIsTheGraphOfItsFreeNodes) {
  const SparseMatrix A = block_stiffness(3, 0.3);
  const PatternGraph graph = pattern_graph(A);
  // The sixteen nodes of one of the four layers are fixed.
  EXPECT_EQ(graph.vertex_count(), 3 * 4 * 4);
  for (std::int32_t v = 0; v < graph.vertex_count(); ++v) {
    EXPECT_EQ(graph.rows(v), 3);
    const auto list = graph.neighbors(v);
    EXPECT_TRUE(std::is_sorted(list.begin(), list.end()));
    for (const std::int32_t u : list) {
      const auto back = graph.neighbors(u);
      EXPECT_TRUE(std::binary_search(back.begin(), back.end(), v));
    }
  }
}

TEST(PatternGraph, ConcurrentCallsGiveTheSameOrders) {
  const PatternGraph graph = pattern_graph(block_stiffness(9, 0.3));
  const auto alone = dissection_order(graph).value();
  std::vector<std::vector<std::int32_t>> orders(8);
  {
    std::vector<std::jthread> threads;
    for (auto& order : orders)
      threads.emplace_back([&order, &graph] { order = dissection_order(graph).value(); });
  }
  for (const auto& order : orders) EXPECT_EQ(order, alone);
}

TEST(PatternGraph, TheOrderContainsEveryVertexOnce) {
  for (const PatternGraph& graph :
       {pattern_graph(block_stiffness(4, 0.3)), pattern_graph(SparseMatrix(0, 0)),
        pattern_graph(lower_triangle(Eigen::MatrixXd::Identity(5, 5)))}) {
    std::vector<std::int32_t> order = dissection_order(graph).value();
    std::sort(order.begin(), order.end());
    std::vector<std::int32_t> all(std::size_t(graph.vertex_count()));
    std::iota(all.begin(), all.end(), 0);
    EXPECT_EQ(order, all);
  }
}

TEST(CholeskyPlan, EveryRowIsInAFrontAndEveryEntryHasATarget) {
  const SparseMatrix A = block_stiffness(6, 0.3, mesh::ElementShape::kTet10);
  const CholeskyPlan plan = plan_cholesky(A).value();
  std::set<std::int32_t> rows(plan.order.begin(), plan.order.end());
  EXPECT_EQ(Index(rows.size()), A.cols());
  std::set<std::int32_t> entries;
  std::int32_t next_row = 0;
  for (std::int32_t s = 0; s < std::int32_t(plan.supernodes.size()); ++s) {
    const Supernode& node = plan.supernodes[std::size_t(s)];
    EXPECT_EQ(node.first_row, next_row);
    next_row += node.own;
    EXPECT_TRUE(node.parent > s || (node.parent == -1 && node.below == 0));
    EXPECT_LE(node.first_descendant, s);
    std::int32_t below = 0;
    for (const RowRun& run : plan.runs_of(s)) below += run.count;
    EXPECT_EQ(below, node.below);
    for (const EntryTarget& entry : plan.entries_of(s)) {
      EXPECT_LT(entry.offset, node.panel_layout().entry_count());
      entries.insert(entry.entry);
    }
  }
  EXPECT_EQ(Index(entries.size()), A.nonZeros());
}

TEST(SparseCholesky, MatchesADenseFactorization) {
  for (unsigned seed = 1; seed <= 20; ++seed)
    for (const Index size : {1, 2, 7, 8, 9, 60, 200}) {
      const double filled = seed % 4 == 0 ? 0.5 : 3.0 / double(size);
      const Eigen::MatrixXd A = random_positive_definite(size, filled, 0.1, seed);
      const VectorX b = some_vector(size), exact = A.ldlt().solve(b);
      const VectorX x = factor_of(lower_triangle(A)).solve(b).value();
      EXPECT_LT((x - exact).norm(), 1e-10 * exact.norm()) << "seed " << seed << ", " << size;
    }
}

TEST(SparseCholesky, MatchesCholmodOnBlocks) {
  for (const auto shape : {mesh::ElementShape::kTet4, mesh::ElementShape::kTet10}) {
    const SparseMatrix A = block_stiffness(8, 0.45, shape);
    const VectorX b = some_vector(A.cols()), peer = solved_by_cholmod(A, b);
    const VectorX x = factor_of(A).solve(b).value();
    EXPECT_LT((x - peer).norm(), 1e-10 * peer.norm());
    const VectorX residual = A.selfadjointView<Eigen::Lower>() * x - b;
    EXPECT_LT(residual.norm(), 1e-11 * b.norm());
  }
}

TEST(SparseCholesky, BitsDoNotDependOnThreadsOrRegisters) {
  const SparseMatrix A = block_stiffness(10, 0.45, mesh::ElementShape::kTet10);
  const VectorX b = some_vector(A.cols());
  const VectorX x = factor_of(A).solve(b).value();
  for (const int threads : {1, 2, 3}) {
    const ThreadLimit limit(threads);
    EXPECT_EQ(factor_of(A).solve(b).value(), x);
  }
  if (best_tile_simd() == TileSimd::kAvx512) {
    EXPECT_EQ(factor_of(A, TileSimd::kAvx2).solve(b).value(), x);
  }
}

TEST(SparseCholesky, RefactorizesWithNewValues) {
  const SparseMatrix A = block_stiffness(5, 0.3);
  SparseCholesky cholesky = factor_of(A);
  const VectorX b = some_vector(A.cols());
  const VectorX x = cholesky.solve(b).value();
  SparseMatrix indefinite = A;
  indefinite.diagonal()[A.cols() / 2] *= -1.0;
  EXPECT_EQ(cholesky.factorize(values(indefinite)), LinearSolveStatus::kNotPositiveDefinite);
  const SparseMatrix fourfold = 4.0 * A;
  EXPECT_EQ(cholesky.factorize(values(fourfold)), LinearSolveStatus::kDone);
  EXPECT_EQ(cholesky.solve(b).value(), 0.25 * x);  // Scaling by powers of two is exact.
}

TEST(SparseCholesky, DetectsAnIndefiniteMatrix) {
  const SparseMatrix A = block_stiffness(5, 0.3);
  SparseCholesky cholesky = factor_of(A);
  for (Index i = 0; i < A.cols(); i += 17) {
    SparseMatrix indefinite = A;
    indefinite.coeffRef(i, i) = -1e-3;
    EXPECT_EQ(cholesky.factorize(values(indefinite)), LinearSolveStatus::kNotPositiveDefinite) << i;
  }
}

TEST(SparseCholesky, AnEmptyMatrixHasAnEmptySolution) {
  EXPECT_EQ(factor_of(SparseMatrix(0, 0)).solve(VectorX(0)).value().size(), 0);
}

TEST(SparseCholesky, PredictsItsMemory) {
  const SparseMatrix A = block_stiffness(6, 0.3);
  const CholeskyPlan plan = plan_cholesky(A).value();
  const std::int64_t needed = 8 * (plan.factor_entries + plan.peak_update);
  EXPECT_EQ(SparseCholesky(plan, needed - 1).factorize(values(A)), LinearSolveStatus::kOutOfMemory);
  const ThreadLimit one(1);  // Other threads would start other subtrees.
  EXPECT_EQ(SparseCholesky(plan, needed).factorize(values(A)), LinearSolveStatus::kDone);
}

}  // namespace
}  // namespace lefort::linear::test_sparse_cholesky
