/// \file
/// Values on the columns of a grid.
#pragma once

#include <lefort/core/parallel.h>
#include <lefort/core/types.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace lefort::dental {

/// One value per column, i fastest; NaN: none.
struct ColumnMap {
  Index width = 0, height = 0;  ///< Number of columns along i and j.
  double spacing_mm = 1.0;
  std::vector<double> values;

  [[nodiscard]] double at(Index i, Index j) const { return values[std::size_t(i + width * j)]; }
};

/// Combines each value with those up to `radius_mm` away, along i and then along j:
/// `combine(value, other, squared_mm)`.
template <class Combine>
ColumnMap filtered(ColumnMap map, double radius_mm, const Combine& combine) {
  const auto reach = Index(std::floor(radius_mm / map.spacing_mm));
  for (const bool along_i : {true, false}) {
    const ColumnMap before = map;
    parallel_for(map.width * map.height, [&](Index column) {
      const Index i = column % map.width, j = column / map.width;
      const Index at = along_i ? i : j, size = along_i ? map.width : map.height;
      double& value = map.values[std::size_t(column)];
      for (Index n = std::max<Index>(at - reach, 0); n <= std::min(at + reach, size - 1); ++n) {
        const double mm = map.spacing_mm * double(n - at);
        value = combine(value, along_i ? before.at(n, j) : before.at(i, n), mm * mm);
      }
    });
  }
  return map;
}

/// \returns the mean over a square around each column, up to `radius_mm` away; NaN is left out.
[[nodiscard]] ColumnMap smoothed(const ColumnMap& map, double radius_mm);

}  // namespace lefort::dental
