/// \file
/// Line plots as inline SVG, without fonts or scripts, with the colors of the page (light or dark).
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace lefort::report {

enum class Axis { kLinear, kLog };

/// Points connected in order. A value that cannot be drawn (NaN, infinite, not positive on a log
/// axis) interrupts the line.
struct PlotLine {
  std::string name{};  ///< For the legend; lines of equal name have one entry and one color.
  std::vector<double> x{};
  std::vector<double> y{};   ///< As many as x.
  bool points_only = false;  ///< Dots without the line.
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

/// \param plot  any texts and numbers.
/// \returns one well-formed <svg> element, 720 units wide. The page may set its colors.
[[nodiscard]] std::string plot_lines(const LinePlot& plot);

/// \param plot  any texts and numbers.
/// \returns the plot as a separate file with fixed colors.
[[nodiscard]] std::string plot_file(const LinePlot& plot);

}  // namespace lefort::report
