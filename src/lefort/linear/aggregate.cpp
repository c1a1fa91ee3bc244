#include <lefort/linear/aggregate.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

namespace lefort::linear {
namespace {

constexpr std::int32_t kNone = -1;

/// Strongly coupled neighbors of each row, without the row itself.
struct StrongNeighbors {
  std::vector<std::int32_t> start, list;

  template <int kRows>
  StrongNeighbors(const BlockMatrix<kRows, kRows>& A, double threshold) {
    std::vector<double> diagonal(std::size_t(A.rows()), 0.0);
    parallel_for(A.rows(), [&](Index i) {
      for (Index k = A.row_begin(i); k < A.row_end(i); ++k)
        if (A.column[std::size_t(k)] == i) diagonal[std::size_t(i)] = A.block(k).norm();
    });
    const double squared = threshold * threshold;
    start.assign(std::size_t(A.rows()) + 1, 0);
    const auto strong = [&](Index i, Index k) {
      const std::int32_t j = A.column[std::size_t(k)];
      return j != i && A.block(k).squaredNorm() >
                           squared * diagonal[std::size_t(i)] * diagonal[std::size_t(j)];
    };
    parallel_for(A.rows(), [&](Index i) {
      for (Index k = A.row_begin(i); k < A.row_end(i); ++k)
        if (strong(i, k)) ++start[std::size_t(i) + 1];
    });
    std::partial_sum(start.begin(), start.end(), start.begin());
    list.resize(std::size_t(start.back()));
    parallel_for(A.rows(), [&](Index i) {
      std::int32_t next = start[std::size_t(i)];
      for (Index k = A.row_begin(i); k < A.row_end(i); ++k)
        if (strong(i, k)) list[std::size_t(next++)] = A.column[std::size_t(k)];
    });
  }

  [[nodiscard]] std::span<const std::int32_t> of(std::int32_t i) const {
    const auto begin = std::size_t(start[std::size_t(i)]);
    return std::span(list).subspan(begin, std::size_t(start[std::size_t(i) + 1]) - begin);
  }
};

}  // namespace

template <int kRows>
Aggregates aggregate(const BlockMatrix<kRows, kRows>& A, double threshold) {
  const StrongNeighbors strong(A, threshold);
  const std::int32_t n = A.rows();
  Aggregates aggregates{.of_row = std::vector<std::int32_t>(std::size_t(n), kNone)};
  std::vector<std::int32_t>& of_row = aggregates.of_row;
  const auto is_free = [&](std::int32_t i) { return of_row[std::size_t(i)] == kNone; };

  // Pass 1: a row with only free neighbors forms an aggregate with them.
  for (std::int32_t i = 0; i < n; ++i) {
    const auto neighbors = strong.of(i);
    if (!is_free(i) || neighbors.empty() ||
        !std::all_of(neighbors.begin(), neighbors.end(), is_free))
      continue;
    of_row[std::size_t(i)] = aggregates.count;
    for (const std::int32_t j : neighbors) of_row[std::size_t(j)] = aggregates.count;
    ++aggregates.count;
  }
  // Pass 2: a free row joins the adjacent aggregate of pass 1 that contains most of its neighbors.
  const std::vector<std::int32_t> after_pass_1 = of_row;
  std::vector<std::int32_t> adjacent;
  for (std::int32_t i = 0; i < n; ++i) {
    if (!is_free(i)) continue;
    adjacent.clear();
    for (const std::int32_t j : strong.of(i))
      if (after_pass_1[std::size_t(j)] != kNone) adjacent.push_back(after_pass_1[std::size_t(j)]);
    std::sort(adjacent.begin(), adjacent.end());
    std::ptrdiff_t maximum = 0;
    for (auto begin = adjacent.begin(); begin != adjacent.end();) {
      const auto end = std::upper_bound(begin, adjacent.end(), *begin);
      if (end - begin > maximum) {
        maximum = end - begin;
        of_row[std::size_t(i)] = *begin;
      }
      begin = end;
    }
  }
  // Pass 3: the remaining rows form aggregates with their free neighbors.
  for (std::int32_t i = 0; i < n; ++i) {
    if (!is_free(i)) continue;
    of_row[std::size_t(i)] = aggregates.count;
    for (const std::int32_t j : strong.of(i))
      if (is_free(j)) of_row[std::size_t(j)] = aggregates.count;
    ++aggregates.count;
  }
  return aggregates;
}

template <int kRows>
CoarseSpace<kRows> coarse_space(const Aggregates& aggregates, const Modes<kRows>& modes) {
  // Below this fraction of the length of a column its remainder is rounding error.
  constexpr double kDependent = 1e-6;
  const auto rows = std::int32_t(aggregates.of_row.size());
  std::vector<std::int32_t> start(std::size_t(aggregates.count) + 1, 0),
      members(aggregates.of_row.size());
  for (const std::int32_t a : aggregates.of_row) ++start[std::size_t(a) + 1];
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<std::int32_t> next(start.begin(), start.end() - 1);
  for (std::int32_t i = 0; i < rows; ++i)
    members[std::size_t(next[std::size_t(aggregates.of_row[std::size_t(i)])]++)] = i;

  CoarseSpace<kRows> coarse;
  coarse.modes.resize(std::size_t(aggregates.count));
  coarse.basis.columns = aggregates.count;
  coarse.basis.start.resize(std::size_t(rows) + 1);
  std::iota(coarse.basis.start.begin(), coarse.basis.start.end(), 0);
  coarse.basis.column = aggregates.of_row;
  coarse.basis.values.resize(std::size_t(rows) * std::size_t(coarse.basis.kSize));
  parallel_for(aggregates.count, [&](Index a) {
    const auto begin = start[std::size_t(a)], end = start[std::size_t(a) + 1];
    Eigen::MatrixXd Q(kRows * (end - begin), 6);
    for (std::int32_t k = begin; k < end; ++k)
      Q.middleRows<kRows>(kRows * (k - begin)) = modes[std::size_t(members[std::size_t(k)])];
    Eigen::Matrix<double, 6, 6>& R = coarse.modes[std::size_t(a)];
    R.setZero();
    for (int c = 0; c < 6; ++c) {
      const double length = Q.col(c).norm();
      // Two passes of Gram-Schmidt give orthogonality to rounding.
      for (int round = 0; round < 2; ++round)
        for (int b = 0; b < c; ++b) {
          const double along = Q.col(b).dot(Q.col(c));
          Q.col(c) -= along * Q.col(b);
          R(b, c) += along;
        }
      const double left = Q.col(c).norm();
      if (left > kDependent * length) {
        R(c, c) = left;
        Q.col(c) /= left;
      } else {
        Q.col(c).setZero();
      }
    }
    for (std::int32_t k = begin; k < end; ++k)
      coarse.basis.block(members[std::size_t(k)]) = Q.middleRows<kRows>(kRows * (k - begin));
  });
  return coarse;
}

template Aggregates aggregate(const BlockMatrix<3, 3>&, double);
template Aggregates aggregate(const BlockMatrix<6, 6>&, double);
template CoarseSpace<3> coarse_space(const Aggregates&, const Modes<3>&);
template CoarseSpace<6> coarse_space(const Aggregates&, const Modes<6>&);

}  // namespace lefort::linear
