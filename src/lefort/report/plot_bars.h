/// \file
/// Stacked horizontal bars as inline SVG.
#pragma once

#include <string>
#include <vector>

namespace lefort::report {

/// One bar: a part of it for each series.
struct Bar {
  std::string name{};
  std::vector<double> parts{};  ///< One per series, >= 0; others are not drawn.
};

struct BarPlot {
  std::string title{};
  std::string x_label{};
  std::vector<std::string> series{};  ///< Names for the legend.
  std::vector<Bar> bars{};
  double end = 1.0;  ///< Value at the right end, > 0.
};

/// \param plot  any texts and numbers.
/// \returns one well-formed <svg> element, 720 units wide.
[[nodiscard]] std::string plot_bars(const BarPlot& plot);

}  // namespace lefort::report
