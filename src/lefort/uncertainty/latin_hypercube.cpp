#include <lefort/core/check.h>
#include <lefort/core/random_draws.h>
#include <lefort/uncertainty/latin_hypercube.h>

#include <algorithm>
#include <random>
#include <utility>
#include <vector>

namespace lefort::uncertainty {
namespace {

/// Fisher and Yates. Not std::shuffle, whose order depends on the library.
void shuffle(std::vector<Index>& items, std::mt19937_64& bits) {
  for (std::size_t k = items.size(); k > 1; --k)
    std::swap(items[k - 1], items[std::size_t(draw_below(bits, Index(k)))]);
}

/// Appends one point to each of `strata` equal intervals of (0, 1) that has none, in random order.
void fill_strata(std::vector<double>& column, Index strata, std::mt19937_64& bits) {
  std::vector<bool> is_taken(std::size_t(strata), false);
  for (const double u : column)
    is_taken[std::size_t(std::min(strata - 1, Index(u * double(strata))))] = true;
  std::vector<Index> empty;
  for (Index k = 0; k < strata; ++k)
    if (!is_taken[std::size_t(k)]) empty.push_back(k);
  shuffle(empty, bits);
  for (const Index k : empty) column.push_back((double(k) + draw_unit(bits)) / double(strata));
}

}  // namespace

Eigen::MatrixXd nested_latin_hypercube(Index inputs, Index count, std::uint64_t seed) {
  LEFORT_CHECK(inputs >= 1 && count >= 1);
  std::mt19937_64 bits(seed);
  std::vector<std::vector<double>> columns(std::size_t(inputs), std::vector<double>{});
  for (Index strata = kFirstDesign;; strata *= 2) {
    for (std::vector<double>& column : columns) fill_strata(column, strata, bits);
    if (strata >= count) break;
  }
  Eigen::MatrixXd points(count, inputs);
  for (Index j = 0; j < inputs; ++j)
    for (Index i = 0; i < count; ++i) points(i, j) = columns[std::size_t(j)][std::size_t(i)];
  return points;
}

}  // namespace lefort::uncertainty
