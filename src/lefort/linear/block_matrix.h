/// \file
/// Sparse matrices of small dense blocks in compressed rows, for products with vectors.
#pragma once

#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/core/types.h>
#include <lefort/linear/sparse_matrix.h>

#include <cstdint>
#include <span>
#include <vector>

namespace lefort::linear {

/// Row i consists of the blocks start[i] to start[i + 1] - 1, by ascending column.
template <int kRows, int kColumns>
struct BlockMatrix {
  using Block = Eigen::Matrix<double, kRows, kColumns>;
  static constexpr Index kSize = kRows * kColumns;

  std::int32_t columns = 0;  ///< Number of block columns.
  std::vector<std::int32_t> start = {0};
  std::vector<std::int32_t> column;
  std::vector<double> values;  ///< kSize for each block; blocks are column-major.

  [[nodiscard]] std::int32_t rows() const { return std::int32_t(start.size()) - 1; }
  [[nodiscard]] Index row_begin(Index i) const { return start[std::size_t(i)]; }
  [[nodiscard]] Index row_end(Index i) const { return start[std::size_t(i) + 1]; }
  [[nodiscard]] Eigen::Map<const Block> block(Index k) const {
    return Eigen::Map<const Block>(values.data() + k * kSize);
  }
  [[nodiscard]] Eigen::Map<Block> block(Index k) {
    return Eigen::Map<Block>(values.data() + k * kSize);
  }
};

/// Block rows that one task multiplies.
inline constexpr Index kBlockRowsPerTask = 512;

/// y = A x.
template <int kRows, int kColumns>
void multiply(const BlockMatrix<kRows, kColumns>& A, const VectorX& x, VectorX& y) {
  LEFORT_CHECK(x.size() == Index(kColumns) * A.columns);
  y.resize(Index(kRows) * A.rows());
  parallel_for(
      A.rows(),
      [&](Index i) {
        Eigen::Matrix<double, kRows, 1> sum = Eigen::Matrix<double, kRows, 1>::Zero();
        for (Index k = A.row_begin(i); k < A.row_end(i); ++k)
          sum.noalias() +=
              A.block(k) * x.segment<kColumns>(Index(kColumns) * A.column[std::size_t(k)]);
        y.segment<kRows>(kRows * i) = sum;
      },
      kBlockRowsPerTask);
}

/// A^T.
template <int kRows, int kColumns>
[[nodiscard]] BlockMatrix<kColumns, kRows> transposed(const BlockMatrix<kRows, kColumns>& A);

/// A symmetric matrix in 3x3 blocks. Consecutive rows with the same pattern, at most three, form a
/// block: the displacements of a node, or those of them that are not prescribed. Smaller blocks are
/// padded with rows of the unit matrix.
class SymmetricBlocks {
 public:
  /// \param A  lower triangle with the whole diagonal, compressed.
  explicit SymmetricBlocks(const SparseMatrix& A);

  /// Sets the values to those of another matrix with the same pattern.
  void set_values(std::span<const double> values);

  [[nodiscard]] const BlockMatrix<3, 3>& matrix() const { return matrix_; }

  /// The row (not block row) of matrix() that contains row i of A.
  [[nodiscard]] std::int32_t row_in_blocks(Index i) const { return row_in_blocks_[std::size_t(i)]; }

  /// Converts between vectors over the rows of A and over the rows of matrix(); padded entries are
  /// zero.
  [[nodiscard]] VectorX to_blocks(const VectorX& x) const;
  [[nodiscard]] VectorX from_blocks(const VectorX& x) const;

 private:
  BlockMatrix<3, 3> matrix_;
  std::vector<std::int32_t> row_in_blocks_;
  std::vector<std::int32_t> offset_;  ///< For each value of A: its position in matrix_.values.
  /// For each value of A: position of the transposed entry, above the diagonal.
  std::vector<std::int32_t> mirror_offset_;
};

}  // namespace lefort::linear
