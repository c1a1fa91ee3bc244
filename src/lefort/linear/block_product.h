/// \file
/// Products of sparse block matrices.
#pragma once

#include <lefort/core/parallel.h>
#include <lefort/linear/block_matrix.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

namespace lefort::linear {

/// The product A B.
template <int kRows, int kInner, int kColumns>
[[nodiscard]] BlockMatrix<kRows, kColumns> product(const BlockMatrix<kRows, kInner>& A,
                                                   const BlockMatrix<kInner, kColumns>& B) {
  using Product = BlockMatrix<kRows, kColumns>;
  using Block = typename Product::Block;
  constexpr Index kRowsPerTask = 2048;
  LEFORT_CHECK(A.columns == B.rows());
  struct Part {
    std::vector<std::int32_t> count, column;
    std::vector<double> values;
  };
  std::vector<Part> parts(std::size_t((A.rows() + kRowsPerTask - 1) / kRowsPerTask));
  parallel_for_blocks(
      A.rows(),
      [&](Index first, Index end) {
        Part& part = parts[std::size_t(first / kRowsPerTask)];
        std::vector<std::int32_t> position(std::size_t(B.columns), -1);  // Of a column in this row.
        std::vector<Block> sums;
        std::vector<std::int32_t> columns;
        for (Index i = first; i < end; ++i) {
          columns.clear();
          for (Index k = A.row_begin(i); k < A.row_end(i); ++k)
            for (Index l = B.row_begin(A.column[std::size_t(k)]);
                 l < B.row_end(A.column[std::size_t(k)]); ++l) {
              std::int32_t& at = position[std::size_t(B.column[std::size_t(l)])];
              if (at < 0) {
                at = std::int32_t(columns.size());
                columns.push_back(B.column[std::size_t(l)]);
                if (sums.size() < columns.size()) sums.emplace_back();
                sums[std::size_t(at)].setZero();
              }
              sums[std::size_t(at)].noalias() += A.block(k) * B.block(l);
            }
          std::vector<std::int32_t> ascending = columns;
          std::sort(ascending.begin(), ascending.end());
          for (const std::int32_t j : ascending) {
            const Block& sum = sums[std::size_t(position[std::size_t(j)])];
            part.values.insert(part.values.end(), sum.data(), sum.data() + Product::kSize);
            position[std::size_t(j)] = -1;
          }
          part.column.insert(part.column.end(), ascending.begin(), ascending.end());
          part.count.push_back(std::int32_t(ascending.size()));
        }
      },
      kRowsPerTask);

  Product C;
  C.columns = B.columns;
  std::size_t blocks = 0;
  for (const Part& part : parts) blocks += part.column.size();
  LEFORT_CHECK(blocks <= std::size_t(std::numeric_limits<std::int32_t>::max()));
  C.column.reserve(blocks);
  C.values.reserve(blocks * std::size_t(Product::kSize));
  for (Part& part : parts) {
    for (const std::int32_t count : part.count) C.start.push_back(C.start.back() + count);
    C.column.insert(C.column.end(), part.column.begin(), part.column.end());
    C.values.insert(C.values.end(), part.values.begin(), part.values.end());
    part = {};
  }
  return C;
}

}  // namespace lefort::linear
