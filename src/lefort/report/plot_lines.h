/// \file
/// Line plots as inline SVG: sharp on screen and paper, no font or script needed, colors from the
/// page (light or dark).
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace lefort::report {

enum class Axis { kLinear, kLog };

/// Points joined in order. A value that cannot be drawn (NaN, infinite, not positive on a log axis)
/// breaks the line.
struct PlotLine {
  std::string name{};  ///< For the legend; lines of equal name share one entry and one color.
  std::vector<double> x{};
  std::vector<double> y{};  ///< As many as x.
};

struct LinePlot {
  std::string title{};
  std::string x_label{};  ///< With its unit.
  std::string y_label{};  ///< With its unit.
  Axis y_axis = Axis::kLinear;
  std::vector<PlotLine> lines{};
  std::vector<double> dividers_x{};     ///< Thin vertical lines, for example between load steps.
  std::optional<double> threshold_y{};  ///< Dashed horizontal line: the tolerance.
  std::string threshold_name{};
};

/// \returns one <svg> element, 720 units wide, well-formed whatever the texts and numbers are. A
///   page around it may set its colors.
[[nodiscard]] std::string plot_lines(const LinePlot& plot);

/// plot_lines() as a file of its own: programs that draw files know no colors of a page.
[[nodiscard]] std::string plot_file(const LinePlot& plot);

}  // namespace lefort::report
