#include <lefort/core/check.h>
#include <lefort/report/internal/plain_text.h>
#include <lefort/report/internal/ticks.h>
#include <lefort/report/plot_lines.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <regex>
#include <string_view>

namespace lefort::report {

namespace {

// The drawing, in units of the view box. y grows downwards, as in SVG.
constexpr double kWidth = 720.0;
constexpr double kHeight = 330.0;
constexpr double kLeft = 78.0;
constexpr double kRight = 704.0;
constexpr double kTop = 44.0;
constexpr double kBottom = 276.0;

/// The page sets these variables for light and dark; the colors here are for a separate file.
constexpr std::array<std::string_view, 4> kLineColors{
    "var(--line-1, #1f5fa8)", "var(--line-2, #b3480f)", "var(--line-3, #2f7d32)",
    "var(--line-4, #7b3fa0)"};
constexpr std::array<std::string_view, 3> kDashes{"", "6 3", "2 3"};
constexpr std::string_view kInkColor = "var(--ink, #20252b)";
constexpr std::string_view kMuted = "var(--muted, #565e68)";
constexpr std::string_view kGrid = "var(--rule, #d9dde2)";

/// Maps a range of values (exponents of ten on a log axis) to a range of the drawing.
struct Scale {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  double at_low = 0.0;
  double at_high = 0.0;

  void extend(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  [[nodiscard]] double position_of(double value) const {
    return at_low + (at_high - at_low) * (value - low) / (high - low);
  }
};

/// \returns the value to be drawn for y; NaN if it cannot be drawn.
double drawn(double y, Axis axis) {
  constexpr double kMaxDrawn = 1e100;  // Differences and margins must not overflow.
  if (axis == Axis::kLog) return y > 0.0 && std::isfinite(y) ? std::log10(y) : NAN;
  return std::abs(y) <= kMaxDrawn ? y : NAN;
}

/// Makes the range valid if there is one value or none.
void ensure_extent(Scale& scale) {
  if (!(scale.low <= scale.high)) scale.low = 0.0, scale.high = 1.0;
  const double minimum = 1e-9 * std::max(1.0, std::max(std::abs(scale.low), std::abs(scale.high)));
  if (scale.high - scale.low < minimum) scale.low -= 0.5, scale.high += 0.5;
  if (scale.high - scale.low < minimum) scale.low -= minimum, scale.high += minimum;
}

struct Scales {
  Scale x;
  Scale y;
};

Scales scales_of(const LinePlot& plot) {
  Scales scales;
  for (const PlotLine& line : plot.lines) {
    LEFORT_CHECK(line.x.size() == line.y.size());
    for (std::size_t i = 0; i < line.x.size(); ++i) {
      const double x = drawn(line.x[i], Axis::kLinear);
      const double y = drawn(line.y[i], plot.y_axis);
      if (std::isnan(x) || std::isnan(y)) continue;
      scales.x.extend(x);
      scales.y.extend(y);
    }
  }
  if (plot.threshold_y) {
    const double y = drawn(*plot.threshold_y, plot.y_axis);
    if (!std::isnan(y)) scales.y.extend(y);
  }
  if (plot.y_axis == Axis::kLinear && scales.y.low > 0.0 && scales.y.high > 0.0)
    scales.y.low = 0.0;  // The axis of lengths and counts starts at zero.
  ensure_extent(scales.x);
  ensure_extent(scales.y);
  if (plot.y_axis == Axis::kLog) {
    scales.y.low = std::floor(scales.y.low);
    scales.y.high = std::ceil(scales.y.high);
  } else {
    scales.y.high += 0.05 * (scales.y.high - scales.y.low);
  }
  const double rim = 0.02 * (scales.x.high - scales.x.low);
  scales.x.low -= rim;
  scales.x.high += rim;
  scales.x.at_low = kLeft;
  scales.x.at_high = kRight;
  scales.y.at_low = kBottom;
  scales.y.at_high = kTop;
  return scales;
}

std::string line_element(double x1, double y1, double x2, double y2, std::string_view style) {
  return fmt::format("<line x1='{:.2f}' y1='{:.2f}' x2='{:.2f}' y2='{:.2f}' style='{}'/>\n", x1, y1,
                     x2, y2, style);
}

std::string text_element(double x, double y, std::string_view anchor, std::string_view color,
                         std::string_view markup) {
  return fmt::format("<text x='{:.2f}' y='{:.2f}' text-anchor='{}' style='fill:{}'>{}</text>\n", x,
                     y, anchor, color, markup);
}

std::string axes(const LinePlot& plot, const Scales& scales) {
  std::string svg;
  const std::string grid = fmt::format("stroke:{};stroke-width:1", kGrid);
  const bool log = plot.y_axis == Axis::kLog;
  for (const double tick : ticks(scales.y.low, scales.y.high, log ? 6 : 5)) {
    if (log && tick != std::round(tick)) continue;
    const double y = scales.y.position_of(tick);
    svg += line_element(kLeft, y, kRight, y, grid);
    const std::string label =
        log ? fmt::format("10<tspan dy='-5' font-size='10'>{:.0f}</tspan>", tick) : tick_text(tick);
    svg += text_element(kLeft - 8.0, y + 4.5, "end", kMuted, label);
  }
  for (const double tick : ticks(scales.x.low, scales.x.high, 8)) {
    const double x = scales.x.position_of(tick);
    svg += line_element(x, kBottom, x, kBottom + 5.0, fmt::format("stroke:{}", kMuted));
    svg += text_element(x, kBottom + 20.0, "middle", kMuted, tick_text(tick));
  }
  svg += line_element(kLeft, kBottom, kRight, kBottom, fmt::format("stroke:{}", kMuted));
  svg += text_element(0.5 * (kLeft + kRight), kHeight - 8.0, "middle", kInkColor,
                      escaped(plot.x_label));
  svg += fmt::format(
      "<text transform='translate(18 {:.2f}) rotate(-90)' text-anchor='middle' "
      "style='fill:{}'>{}</text>\n",
      0.5 * (kTop + kBottom), kInkColor, escaped(plot.y_label));
  return svg;
}

/// Colors repeat with other dashes.
struct LineStyle {
  std::string_view color;
  std::string_view dashes;  ///< Empty for none.
};

LineStyle look_of(std::size_t line) {
  return {kLineColors[line % kLineColors.size()],
          kDashes[line / kLineColors.size() % kDashes.size()]};
}

std::string stroke(const LineStyle& look) {
  return look.dashes.empty()
             ? fmt::format("stroke:{}", look.color)
             : fmt::format("stroke:{};stroke-dasharray:{}", look.color, look.dashes);
}

/// \returns the line, interrupted at gaps, with a dot at each point.
std::string curve(const PlotLine& line, Axis y_axis, const Scales& scales, const LineStyle& look) {
  std::string path;
  std::string dots;
  bool pen_down = false;
  for (std::size_t i = 0; i < line.x.size(); ++i) {
    const double x = drawn(line.x[i], Axis::kLinear);
    const double y = drawn(line.y[i], y_axis);
    if (std::isnan(x) || std::isnan(y)) {
      pen_down = false;
      continue;
    }
    const double at_x = scales.x.position_of(x);
    const double at_y = scales.y.position_of(y);
    path += fmt::format("{}{:.2f} {:.2f} ", pen_down ? 'L' : 'M', at_x, at_y);
    dots += fmt::format("<circle cx='{:.2f}' cy='{:.2f}' r='2.4' style='fill:{}'/>\n", at_x, at_y,
                        look.color);
    pen_down = true;
  }
  if (path.empty()) return {};
  if (line.points_only) return dots;
  path.pop_back();
  return fmt::format("<path d='{}' style='fill:none;stroke-width:1.8;{}'/>\n", path, stroke(look)) +
         dots;
}

/// Entries above the plot, in one or several rows.
class Legend {
 public:
  void add(std::string_view name, std::string_view line_style) {
    constexpr double kLetter = 7.0;  // Mean advance at 13 units.
    const double width = 28.0 + kLetter * double(name.size());
    if (x_ > kLeft && x_ + width > kWidth) {
      x_ = kLeft;
      y_ += kRow;
    }
    entries_ += line_element(x_, y_ - 4.5, x_ + 22.0, y_ - 4.5, line_style);
    entries_ += text_element(x_ + 28.0, y_, "start", kInkColor, escaped(name));
    x_ += width + 22.0;
  }

  /// Additional height of the drawing for rows beyond the first.
  [[nodiscard]] double height() const { return y_ - kFirst; }
  [[nodiscard]] std::string svg() const {
    return fmt::format("<g transform='translate(0 {:.0f})'>\n{}</g>\n", -height(), entries_);
  }

 private:
  static constexpr double kFirst = 26.0;
  static constexpr double kRow = 18.0;
  double x_ = kLeft;
  double y_ = kFirst;
  std::string entries_;
};

}  // namespace

std::string plot_lines(const LinePlot& plot) {
  const Scales scales = scales_of(plot);
  std::string svg = axes(plot, scales);
  for (const double divider : plot.dividers_x) {
    const double x = scales.x.position_of(divider);
    if (x >= kLeft && x <= kRight)
      svg +=
          line_element(x, kTop, x, kBottom, fmt::format("stroke:{};stroke-dasharray:2 4", kMuted));
  }
  Legend legend;
  std::vector<std::string> names;
  for (const PlotLine& line : plot.lines) {
    auto known = std::find(names.begin(), names.end(), line.name);
    const bool is_new = known == names.end();
    if (is_new) known = names.insert(names.end(), line.name);
    const LineStyle look = look_of(std::size_t(known - names.begin()));
    if (is_new) legend.add(line.name, stroke(look) + ";stroke-width:2.4");
    svg += curve(line, plot.y_axis, scales, look);
  }
  const double threshold = plot.threshold_y ? drawn(*plot.threshold_y, plot.y_axis) : NAN;
  if (!std::isnan(threshold)) {
    const std::string style =
        fmt::format("stroke:{};stroke-width:1.6;stroke-dasharray:7 4", kInkColor);
    const double y = scales.y.position_of(threshold);
    svg += line_element(kLeft, y, kRight, y, style);
    legend.add(plot.threshold_name, style);
  }
  return fmt::format(
             "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 {:.0f} {} {:.0f}' role='img' "
             "aria-label='{}' font-family='system-ui, sans-serif' font-size='13'>\n"
             "<title>{}</title>\n",
             -legend.height(), kWidth, kHeight + legend.height(), escaped(plot.title),
             escaped(plot.title)) +
         svg + legend.svg() + "</svg>\n";
}

std::string plot_file(const LinePlot& plot) {
  static const std::regex kVariable(R"(var\(--[a-z0-9-]+, (#[0-9a-f]+)\))");
  return std::regex_replace(plot_lines(plot), kVariable, "$1");
}

}  // namespace lefort::report
