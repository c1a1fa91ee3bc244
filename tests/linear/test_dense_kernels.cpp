#include <lefort/linear/dense_kernels.h>
#include <lefort/linear/tile_layout.h>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <vector>

#include "fem/random_deformation.h"

namespace lefort::linear::test_dense_kernels {
namespace {

using Matrix = Eigen::MatrixXd;

Matrix random_matrix(Index rows, Index columns, unsigned seed) {
  test::RandomDeformation random(seed);
  return Matrix::NullaryExpr(rows, columns, [&] { return random.number(); });
}

/// A positive definite matrix whose upper triangle has values that must not be read.
Matrix lower_only(Index rows, unsigned seed) {
  const Matrix B = random_matrix(rows, rows, seed);
  Matrix A = B * B.transpose() + Matrix::Identity(rows, rows);
  A.triangularView<Eigen::StrictlyUpper>().setConstant(std::numeric_limits<double>::quiet_NaN());
  return A;
}

Matrix lower(const Matrix& A) { return A.triangularView<Eigen::Lower>(); }

std::vector<TileSimd> sets_of_this_processor() {
  std::vector<TileSimd> sets{TileSimd::kBaseline};
  if (best_tile_simd() >= TileSimd::kAvx2) sets.push_back(TileSimd::kAvx2);
  if (best_tile_simd() >= TileSimd::kAvx512) sets.push_back(TileSimd::kAvx512);
  return sets;
}

const std::vector<int> kSizes{8, 16, 24, 40, 64, kTile};

TEST(DenseKernels, ProductsMatchEigen) {
  for (const TileSimd simd : sets_of_this_processor()) {
    const TileKernels& kernels = tile_kernels(simd);
    for (const int rows : kSizes)
      for (const int columns : kSizes)
        for (const int depth : {1, 7, 24, kTile}) {
          const Matrix A = random_matrix(rows, depth, 1), B = random_matrix(columns, depth, 2);
          const Matrix C = random_matrix(rows, columns, 3);
          Matrix difference = C, minus = C;
          kernels.subtract_product(difference.data(), A.data(), B.data(), rows, columns, depth);
          kernels.minus_product(minus.data(), A.data(), B.data(), rows, columns, depth);
          EXPECT_LT((difference - (C - A * B.transpose())).norm(), 1e-12);
          EXPECT_LT((minus + A * B.transpose()).norm(), 1e-12);
        }
  }
}

TEST(DenseKernels, SquaresAreValidInTheLowerTriangle) {
  for (const TileSimd simd : sets_of_this_processor()) {
    const TileKernels& kernels = tile_kernels(simd);
    for (const int rows : kSizes)
      for (const int depth : {1, 7, 24, kTile}) {
        const Matrix A = random_matrix(rows, depth, 1), C = random_matrix(rows, rows, 3);
        Matrix difference = C, minus = C;
        kernels.subtract_square(difference.data(), A.data(), rows, depth);
        kernels.minus_square(minus.data(), A.data(), rows, depth);
        EXPECT_LT(lower(difference - (C - A * A.transpose())).norm(), 1e-12);
        EXPECT_LT(lower(minus + A * A.transpose()).norm(), 1e-12);
      }
  }
}

TEST(DenseKernels, AFactorTimesItselfIsTheMatrix) {
  for (const TileSimd simd : sets_of_this_processor())
    for (const int rows : kSizes) {
      const Matrix A = lower_only(rows, 4);
      Matrix L = A;
      ASSERT_TRUE(tile_kernels(simd).factorize(L.data(), rows));
      L = lower(L);
      EXPECT_LT(lower(L * L.transpose() - lower(A)).norm(), 1e-13 * lower(A).norm());
    }
}

TEST(DenseKernels, ReportsAPivotThatIsNotPositive) {
  for (const TileSimd simd : sets_of_this_processor())
    for (const double pivot : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()})
      for (const int at : {0, 5, 30, 63}) {
        Matrix A = Matrix::Identity(64, 64);
        A(at, at) = pivot;
        EXPECT_FALSE(tile_kernels(simd).factorize(A.data(), 64));
      }
}

TEST(DenseKernels, DivisionAndSubstitutionUndoTheFactor) {
  for (const TileSimd simd : sets_of_this_processor()) {
    const TileKernels& kernels = tile_kernels(simd);
    for (const int size : kSizes) {
      Matrix L = lower_only(size, 5);
      ASSERT_TRUE(kernels.factorize(L.data(), size));
      L.triangularView<Eigen::StrictlyUpper>().setConstant(1e300);
      const Matrix exact = lower(L);
      for (const int rows : kSizes) {
        const Matrix B = random_matrix(rows, size, 6);
        Matrix X = B;
        kernels.divide_by_factor(X.data(), L.data(), rows, size);
        EXPECT_LT((X * exact.transpose() - B).norm(), 1e-11);
      }
      const VectorX b = random_matrix(size, 1, 7);
      VectorX x = b;
      kernels.solve_forward(x.data(), L.data(), size);
      EXPECT_LT((exact * x - b).norm(), 1e-12);
      x = b;
      kernels.solve_backward(x.data(), L.data(), size);
      EXPECT_LT((exact.transpose() * x - b).norm(), 1e-12);
    }
  }
}

TEST(DenseKernels, ProductsWithVectorsMatchEigen) {
  for (const TileSimd simd : sets_of_this_processor())
    for (const int rows : kSizes)
      for (const int columns : kSizes) {
        const Matrix A = random_matrix(rows, columns, 8);
        const VectorX x = random_matrix(columns, 1, 9), y = random_matrix(rows, 1, 10);
        VectorX times = y, transposed = x;
        tile_kernels(simd).subtract_times(times.data(), A.data(), x.data(), rows, columns);
        tile_kernels(simd).subtract_transposed_times(transposed.data(), A.data(), y.data(), rows,
                                                     columns);
        EXPECT_LT((times - (y - A * x)).norm(), 1e-12);
        EXPECT_LT((transposed - (x - A.transpose() * y)).norm(), 1e-12);
      }
}

TEST(DenseKernels, WiderRegistersGiveTheSameBits) {
  if (best_tile_simd() != TileSimd::kAvx512) GTEST_SKIP() << "this processor has no AVX-512";
  const TileKernels &narrow = tile_kernels(TileSimd::kAvx2),
                    &wide = tile_kernels(TileSimd::kAvx512);
  const auto both = [](Matrix start, const auto& run) {
    Matrix other = start;
    return std::pair(run(0, start), run(1, other));
  };
  for (const int size : kSizes) {
    const Matrix A = random_matrix(size, size, 1), C = random_matrix(size, size, 2);
    const auto product = both(C, [&](int which, Matrix& X) {
      (which == 0 ? narrow : wide).subtract_product(X.data(), A.data(), C.data(), size, size, size);
      return X;
    });
    EXPECT_EQ(product.first, product.second);
    const auto factor = both(lower_only(size, 3), [&](int which, Matrix& X) {
      EXPECT_TRUE((which == 0 ? narrow : wide).factorize(X.data(), size));
      return lower(X);
    });
    EXPECT_EQ(factor.first, factor.second);
    const auto quotient = both(C, [&](int which, Matrix& X) {
      (which == 0 ? narrow : wide).divide_by_factor(X.data(), factor.first.data(), size, size);
      return X;
    });
    EXPECT_EQ(quotient.first, quotient.second);
    const auto vectors = both(random_matrix(size, 1, 4), [&](int which, Matrix& x) {
      const TileKernels& kernels = which == 0 ? narrow : wide;
      kernels.solve_forward(x.data(), factor.first.data(), size);
      kernels.solve_backward(x.data(), factor.first.data(), size);
      Matrix y = x;
      kernels.subtract_times(y.data(), A.data(), x.data(), size, size);
      kernels.subtract_transposed_times(x.data(), A.data(), y.data(), size, size);
      return x;
    });
    EXPECT_EQ(vectors.first, vectors.second);
  }
}

TEST(TileLayout, TilesAreContiguous) {
  for (const int own : {8, kTile, kTile + 8, 3 * kTile})
    for (const int below : {0, 8, kTile, 2 * kTile + 16}) {
      const TileLayout layout(own, below);
      std::int64_t next = 0;
      for (int j = 0; j < layout.own_tiles(); ++j)
        for (int i = j; i < layout.all_tiles(); ++i) {
          EXPECT_EQ(layout.offset(i, j), next);
          next += std::int64_t(layout.size(i)) * layout.size(j);
        }
      EXPECT_EQ(layout.entry_count(), next);
      for (int row = 0; row < layout.rows(); ++row) {
        const int t = layout.tile_of(row);
        EXPECT_GE(row, layout.start(t));
        EXPECT_LT(row, layout.start(t) + layout.size(t));
      }
    }
}

}  // namespace
}  // namespace lefort::linear::test_dense_kernels
