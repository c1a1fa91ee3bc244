#include <lefort/core/check.h>
#include <lefort/core/types.h>
#include <lefort/linear/pattern_graph.h>

#include <metis.h>

#include <algorithm>
#include <mutex>
#include <numeric>

namespace lefort::linear {
namespace {

/// For each row, whether it is the first row of a vertex.
std::vector<char> first_rows(const SparseMatrix& A) {
  const int* const start = A.outerIndexPtr();
  const int* const row = A.innerIndexPtr();
  std::vector<char> is_first(std::size_t(A.cols()) + 1, 0);
  is_first.front() = is_first.back() = 1;
  for (Index j = 0; j < A.cols(); ++j) {
    const int *const begin = row + start[j], *const end = row + start[j + 1];
    LEFORT_CHECK(begin != end && *begin == j);
    // Right of column j, adjacent rows differ if only one of them is in the column.
    for (const int* i = begin; i != end; ++i) {
      if (i != begin && i[-1] + 1 != *i) is_first[std::size_t(*i)] = 1;
      if (i + 1 == end || *i + 1 != i[1]) is_first[std::size_t(*i) + 1] = 1;
    }
    // Left of it, columns j - 1 and j must have the same rows below the diagonal.
    if (j > 0) {
      const int *const before = row + start[j - 1] + 1, *const before_end = begin;
      if (!std::equal(before, before_end, begin, end)) is_first[std::size_t(j)] = 1;
    }
  }
  return is_first;
}

}  // namespace

PatternGraph pattern_graph(const SparseMatrix& A) {
  LEFORT_CHECK(A.rows() == A.cols() && A.isCompressed());
  if (A.cols() == 0) return {};
  const std::vector<char> is_first = first_rows(A);
  PatternGraph graph;
  graph.first_row.clear();
  std::vector<std::int32_t> vertex_of_row(std::size_t(A.cols()));
  for (Index i = 0; i < A.cols(); ++i) {
    if (is_first[std::size_t(i)] != 0) graph.first_row.push_back(std::int32_t(i));
    vertex_of_row[std::size_t(i)] = std::int32_t(graph.first_row.size()) - 1;
  }
  graph.first_row.push_back(std::int32_t(A.cols()));

  // Two passes over the pairs below the diagonal: one counts, one stores.
  const std::int32_t n = graph.vertex_count();
  const auto for_each_pair = [&](const auto& visit) {
    for (std::int32_t v = 0; v < n; ++v) {
      const int column = graph.first_row[std::size_t(v)];
      std::int32_t last = v;
      for (int k = A.outerIndexPtr()[column]; k < A.outerIndexPtr()[column + 1]; ++k) {
        const std::int32_t u = vertex_of_row[std::size_t(A.innerIndexPtr()[k])];
        if (u == last) continue;
        last = u;
        visit(v, u);
      }
    }
  };
  graph.start.assign(std::size_t(n) + 1, 0);
  for_each_pair([&](std::int32_t v, std::int32_t u) {
    ++graph.start[std::size_t(v) + 1];
    ++graph.start[std::size_t(u) + 1];
  });
  std::partial_sum(graph.start.begin(), graph.start.end(), graph.start.begin());
  graph.neighbor.resize(std::size_t(graph.start.back()));
  std::vector<std::int32_t> next(graph.start.begin(), graph.start.end() - 1);
  // Pairs come by ascending v. Storing smaller neighbors first gives sorted lists.
  for_each_pair([&](std::int32_t v, std::int32_t u) {
    graph.neighbor[std::size_t(next[std::size_t(u)]++)] = v;
  });
  for_each_pair([&](std::int32_t v, std::int32_t u) {
    graph.neighbor[std::size_t(next[std::size_t(v)]++)] = u;
  });
  return graph;
}

std::optional<std::vector<std::int32_t>> dissection_order(const PatternGraph& graph) {
  const std::int32_t n = graph.vertex_count();
  std::vector<std::int32_t> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), 0);
  if (graph.neighbor.empty()) return order;  // METIS does not accept an empty graph.

  std::vector<idx_t> start(graph.start.begin(), graph.start.end());
  std::vector<idx_t> neighbor(graph.neighbor.begin(), graph.neighbor.end());
  std::vector<idx_t> weight, old_of_new(order.size()), new_of_old(order.size());
  for (std::int32_t v = 0; v < n; ++v) weight.push_back(graph.rows(v));
  idx_t count = n;
  std::vector<idx_t> options(METIS_NOPTIONS);
  METIS_SetDefaultOptions(options.data());
  options[METIS_OPTION_COMPRESS] = 0;  // Done by pattern_graph().
  // Debian's METIS uses rand() and seeds it at the start of a call. Concurrent calls would disturb
  // each other's sequence and give different orders.
  static std::mutex one_at_a_time;
  const std::scoped_lock lock(one_at_a_time);
  const int outcome = METIS_NodeND(&count, start.data(), neighbor.data(), weight.data(),
                                   options.data(), old_of_new.data(), new_of_old.data());
  if (outcome != METIS_OK) return std::nullopt;
  std::copy(old_of_new.begin(), old_of_new.end(), order.begin());
  return order;
}

}  // namespace lefort::linear
