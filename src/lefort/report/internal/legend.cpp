#include <lefort/report/internal/legend.h>
#include <lefort/report/internal/ticks.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lefort::report {

double letter_px(int picture_width) { return std::clamp(picture_width / 72.0, 9.0, 48.0); }

void write_color_bar(Canvas& canvas, const Rectangle& area, const ColorBar& what, double em) {
  // On whole pixels: otherwise the background between two columns would change the colors.
  const Rectangle bar{std::round(area.left), std::round(area.top), std::round(area.width),
                      std::round(area.height)};
  const int columns = int(bar.width);
  for (int x = 0; x < columns; ++x)
    canvas.fill({bar.left + x, bar.top, 1.0, bar.height},
                color_at(what.scale.map, (x + 0.5) / bar.width));
  canvas.outline(bar, kInk, 0.06 * em);
  const std::string title =
      what.unit.empty() ? what.title : fmt::format("{} [{}]", what.title, what.unit);
  canvas.write(bar.left + 0.5 * bar.width, bar.top - 0.5 * em, title,
               {.size_px = em, .color = kInk, .align = Align::kCenter}, 1.6 * bar.width);
  const double low = what.scale.low;
  for (const double tick : ticks(low, what.scale.high, 5)) {
    const double x = bar.left + bar.width * (tick - low) / (what.scale.high - low);
    canvas.fill({x - 0.03 * em, bar.top + bar.height, 0.06 * em, 0.35 * em}, kInk);
    canvas.write(x, bar.top + bar.height + 1.35 * em, tick_text(tick),
                 {.size_px = 0.9 * em, .color = kInk, .align = Align::kCenter}, 4.0 * em);
  }
}

void write_scale(Canvas& canvas, double right, double middle, double mm_per_pixel, int width,
                 double em) {
  const double length_mm = round_below(0.16 * width * mm_per_pixel);
  const double length_px = length_mm / mm_per_pixel;
  const double left = right - length_px;
  canvas.fill({left, middle - 0.07 * em, length_px, 0.14 * em}, kInk);
  for (const double end : {left, right})
    canvas.fill({end - 0.05 * em, middle - 0.4 * em, 0.1 * em, 0.8 * em}, kInk);
  canvas.write(left - 0.6 * em, middle + 0.35 * em, fmt::format("{} mm", tick_text(length_mm)),
               {.size_px = 0.9 * em, .color = kInk, .align = Align::kRight}, 0.2 * width);
}

}  // namespace lefort::report
