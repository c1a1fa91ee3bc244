#include <lefort/core/check.h>
#include <lefort/report/internal/plain_text.h>
#include <lefort/report/plot_bars.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace lefort::report {
namespace {

// Units of the view box.
constexpr double kBarWidth = 720.0, kBarLeft = 128.0, kBarRight = 690.0;
constexpr double kBarHeight = 20.0, kBarStep = 30.0, kBarTop = 12.0;

/// Distinct in gray, too: the palette of Okabe and Ito, then gray.
constexpr std::array<std::string_view, 9> kBarColors{"#0072b2", "#e69f00", "#009e73",
                                                     "#cc79a7", "#56b4e9", "#d55e00",
                                                     "#f0e442", "#7f5fb0", "#9aa0a6"};

std::string bar_text(double x, double y, std::string_view anchor, std::string_view color,
                     std::string_view text) {
  return fmt::format(
      "<text x='{:.2f}' y='{:.2f}' text-anchor='{}' style='fill:var({})'>{}</text>\n", x, y, anchor,
      color, escaped(text));
}

std::string one_bar(const Bar& bar, double y, double scale) {
  std::string svg = bar_text(kBarLeft - 8.0, y + 14.5, "end", "--ink, #20252b", bar.name);
  double x = kBarLeft;
  for (std::size_t s = 0; s < bar.parts.size(); ++s) {
    const double width = scale * bar.parts[s];
    if (!(width > 0.0) || !std::isfinite(width) || x + width > kBarWidth) continue;
    svg += fmt::format("<rect x='{:.2f}' y='{:.2f}' width='{:.2f}' height='{}' style='fill:{}'/>\n",
                       x, y, width, kBarHeight, kBarColors[s % kBarColors.size()]);
    x += width;
  }
  return svg;
}

}  // namespace

std::string plot_bars(const BarPlot& plot) {
  LEFORT_CHECK(plot.end > 0.0);
  const double scale = (kBarRight - kBarLeft) / plot.end;
  const double bottom = kBarTop + kBarStep * double(plot.bars.size());
  std::string svg;
  constexpr int kTicks = 5;
  for (int n = 0; n <= kTicks; ++n) {
    const double value = plot.end * n / kTicks, x = kBarLeft + scale * value;
    svg += fmt::format(
        "<line x1='{0:.2f}' y1='{1:.2f}' x2='{0:.2f}' y2='{2:.2f}' "
        "style='stroke:var(--rule, #d9dde2)'/>\n",
        x, kBarTop - 6.0, bottom);
    svg += bar_text(x, bottom + 16.0, "middle", "--muted, #565e68", fmt::format("{:g}", value));
  }
  for (std::size_t b = 0; b < plot.bars.size(); ++b)
    svg += one_bar(plot.bars[b], kBarTop + kBarStep * double(b), scale);
  svg += bar_text(0.5 * (kBarLeft + kBarRight), bottom + 36.0, "middle", "--ink, #20252b",
                  plot.x_label);
  double x = kBarLeft, y = bottom + 60.0;
  for (std::size_t s = 0; s < plot.series.size(); ++s) {
    const double width = 30.0 + 7.0 * double(plot.series[s].size());
    if (x > kBarLeft && x + width > kBarWidth) {
      x = kBarLeft;
      y += 20.0;
    }
    svg += fmt::format("<rect x='{:.2f}' y='{:.2f}' width='14' height='12' style='fill:{}'/>\n", x,
                       y - 11.0, kBarColors[s % kBarColors.size()]);
    svg += bar_text(x + 20.0, y, "start", "--ink, #20252b", plot.series[s]);
    x += width + 10.0;
  }
  return fmt::format(
             "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {} {:.0f}' role='img' "
             "aria-label='{}' font-family='system-ui, sans-serif' font-size='13'>\n"
             "<title>{}</title>\n",
             kBarWidth, y + 14.0, escaped(plot.title), escaped(plot.title)) +
         svg + "</svg>\n";
}

}  // namespace lefort::report
