#include <lefort/dental/column_map.h>

#include <limits>

namespace lefort::dental {

ColumnMap smoothed(const ColumnMap& map, double radius_mm) {
  ColumnMap result = map;
  const auto reach = Index(std::ceil(radius_mm / map.spacing_mm));
  parallel_for(map.width * map.height, [&](Index column) {
    const Index i = column % map.width, j = column / map.width;
    double sum = 0.0;
    Index count = 0;
    for (Index b = std::max<Index>(j - reach, 0); b <= std::min(j + reach, map.height - 1); ++b)
      for (Index a = std::max<Index>(i - reach, 0); a <= std::min(i + reach, map.width - 1); ++a)
        if (const double value = map.at(a, b); !std::isnan(value)) {
          sum += value;
          ++count;
        }
    result.values[std::size_t(column)] =
        count > 0 ? sum / double(count) : std::numeric_limits<double>::quiet_NaN();
  });
  return result;
}

}  // namespace lefort::dental
