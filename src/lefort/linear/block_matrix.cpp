#include <lefort/linear/block_matrix.h>
#include <lefort/linear/pattern_graph.h>

#include <algorithm>
#include <limits>
#include <numeric>

namespace lefort::linear {

template <int kRows, int kColumns>
BlockMatrix<kColumns, kRows> transposed(const BlockMatrix<kRows, kColumns>& A) {
  BlockMatrix<kColumns, kRows> T;
  T.columns = A.rows();
  T.start.assign(std::size_t(A.columns) + 1, 0);
  for (const std::int32_t j : A.column) ++T.start[std::size_t(j) + 1];
  std::partial_sum(T.start.begin(), T.start.end(), T.start.begin());
  T.column.resize(A.column.size());
  T.values.resize(A.values.size());
  std::vector<std::int32_t> next(T.start.begin(), T.start.end() - 1);
  for (Index i = 0; i < A.rows(); ++i)
    for (Index k = A.row_begin(i); k < A.row_end(i); ++k) {
      const std::int32_t at = next[std::size_t(A.column[std::size_t(k)])]++;
      T.column[std::size_t(at)] = std::int32_t(i);
      T.block(at) = A.block(k).transpose();
    }
  return T;
}

template BlockMatrix<6, 3> transposed(const BlockMatrix<3, 6>&);
template BlockMatrix<6, 6> transposed(const BlockMatrix<6, 6>&);

namespace {

constexpr std::int32_t kBlock = 3;

/// The first block of each vertex of the graph, and at the end the number of blocks.
std::vector<std::int32_t> first_blocks(const PatternGraph& graph) {
  std::vector<std::int32_t> first{0};
  for (std::int32_t v = 0; v < graph.vertex_count(); ++v)
    first.push_back(first.back() + (graph.rows(v) + kBlock - 1) / kBlock);
  return first;
}

}  // namespace

SymmetricBlocks::SymmetricBlocks(const SparseMatrix& A) {
  const PatternGraph graph = pattern_graph(A);
  const std::vector<std::int32_t> first = first_blocks(graph);
  row_in_blocks_.resize(std::size_t(A.rows()));
  matrix_.columns = first.back();
  for (std::int32_t v = 0; v < graph.vertex_count(); ++v) {
    for (std::int32_t r = 0; r < graph.rows(v); ++r)
      row_in_blocks_[std::size_t(graph.first_row[std::size_t(v)] + r)] =
          kBlock * first[std::size_t(v)] + r;
    const auto add_blocks_of = [&](std::int32_t u) {
      for (std::int32_t b = first[std::size_t(u)]; b < first[std::size_t(u) + 1]; ++b)
        matrix_.column.push_back(b);
    };
    const auto neighbors = graph.neighbors(v);
    const auto above = std::lower_bound(neighbors.begin(), neighbors.end(), v);
    for (std::int32_t b = first[std::size_t(v)]; b < first[std::size_t(v) + 1]; ++b) {
      std::for_each(neighbors.begin(), above, add_blocks_of);
      add_blocks_of(v);
      std::for_each(above, neighbors.end(), add_blocks_of);
      LEFORT_CHECK(matrix_.column.size() * matrix_.kSize <
                   std::size_t(std::numeric_limits<std::int32_t>::max()));
      matrix_.start.push_back(std::int32_t(matrix_.column.size()));
    }
  }
  matrix_.values.assign(matrix_.column.size() * std::size_t(matrix_.kSize), 0.0);

  const auto offset_of = [&](std::int32_t i, std::int32_t j) {
    const auto begin = matrix_.column.begin() + matrix_.start[std::size_t(i / kBlock)];
    const auto end = matrix_.column.begin() + matrix_.start[std::size_t(i / kBlock) + 1];
    const auto k = std::lower_bound(begin, end, j / kBlock) - matrix_.column.begin();
    return std::int32_t(k * matrix_.kSize + j % kBlock * kBlock + i % kBlock);
  };
  offset_.resize(std::size_t(A.nonZeros()));
  mirror_offset_.resize(std::size_t(A.nonZeros()));
  parallel_for(A.cols(), [&](Index column) {
    const std::int32_t j = row_in_blocks(column);
    for (int k = A.outerIndexPtr()[column]; k < A.outerIndexPtr()[column + 1]; ++k) {
      const std::int32_t i = row_in_blocks(A.innerIndexPtr()[k]);
      offset_[std::size_t(k)] = offset_of(i, j);
      mirror_offset_[std::size_t(k)] = offset_of(j, i);
    }
  });
  for (std::int32_t v = 0; v < graph.vertex_count(); ++v)
    for (std::int32_t i = kBlock * first[std::size_t(v)] + graph.rows(v);
         i < kBlock * first[std::size_t(v) + 1]; ++i)
      matrix_.values[std::size_t(offset_of(i, i))] = 1.0;
  set_values({A.valuePtr(), std::size_t(A.nonZeros())});
}

void SymmetricBlocks::set_values(std::span<const double> values) {
  LEFORT_CHECK(values.size() == offset_.size());
  parallel_for(Index(values.size()), [&](Index k) {
    const double value = values[std::size_t(k)];
    matrix_.values[std::size_t(offset_[std::size_t(k)])] = value;
    matrix_.values[std::size_t(mirror_offset_[std::size_t(k)])] = value;
  });
}

VectorX SymmetricBlocks::to_blocks(const VectorX& x) const {
  VectorX blocks = VectorX::Zero(Index(kBlock) * matrix_.rows());
  for (Index i = 0; i < x.size(); ++i) blocks[row_in_blocks(i)] = x[i];
  return blocks;
}

VectorX SymmetricBlocks::from_blocks(const VectorX& x) const {
  VectorX rows(Index(row_in_blocks_.size()));
  for (Index i = 0; i < rows.size(); ++i) rows[i] = x[row_in_blocks(i)];
  return rows;
}

}  // namespace lefort::linear
