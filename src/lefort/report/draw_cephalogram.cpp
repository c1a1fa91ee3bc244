#include <lefort/core/version.h>
#include <lefort/report/draw_cephalogram.h>
#include <lefort/report/internal/canvas.h>
#include <lefort/report/internal/legend.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace lefort::report {
namespace {

Picture grays_of(const CephalogramDrawing& drawing) {
  constexpr double kQuantile = 0.998, kPower = 0.6;
  std::vector<double> sorted = drawing.water_mm;
  const auto at = sorted.begin() + std::ptrdiff_t(kQuantile * double(sorted.size() - 1));
  std::nth_element(sorted.begin(), at, sorted.end());
  const double white_mm = std::max(*at, 1.0);
  Picture picture{drawing.columns, drawing.rows, {}};
  picture.rgba.reserve(4 * drawing.water_mm.size());
  for (const double thickness_mm : drawing.water_mm) {
    const double gray = std::pow(std::clamp(thickness_mm / white_mm, 0.0, 1.0), kPower);
    const auto byte = std::uint8_t(std::lround(255.0 * gray));
    picture.rgba.insert(picture.rgba.end(), {byte, byte, byte, 255});
  }
  return picture;
}

void draw_points(Canvas& canvas, const CephalogramDrawing& drawing, const Rectangle& panel,
                 double em) {
  for (const TracedPoint& point : drawing.points) {
    const double half_px = 0.28 * em;
    const std::vector<geometry::Segment2> cross{
        {point.at - Eigen::Vector2d(half_px, 0.0), point.at + Eigen::Vector2d(half_px, 0.0)},
        {point.at - Eigen::Vector2d(0.0, half_px), point.at + Eigen::Vector2d(0.0, half_px)}};
    const Eigen::Vector2d shift(panel.left, panel.top);
    canvas.strokes(cross, shift, panel, point.color, 0.1 * em);
    if (!point.name.empty())
      canvas.write(panel.left + point.at.x() + 0.4 * em, panel.top + point.at.y() - 0.2 * em,
                   point.name, {.size_px = 0.75 * em, .color = point.color}, 6.0 * em);
  }
}

void draw_legend(Canvas& canvas, const CephalogramDrawing& drawing, double left, double top,
                 double width, double em) {
  const double column_px = width / 3.0;
  for (std::size_t n = 0; n < drawing.tracings.size(); ++n) {
    const std::size_t column = n % 3, row = n / 3;
    const double x = left + column_px * double(column), y = top + 1.5 * em * double(row);
    const geometry::Segment2 line{{x, y}, {x + 2.0 * em, y}};
    canvas.strokes({&line, 1}, Eigen::Vector2d::Zero(), {x, y - em, 3.0 * em, 2.0 * em},
                   drawing.tracings[n].color, 0.18 * em);
    canvas.write(x + 2.5 * em, y + 0.3 * em, drawing.tracings[n].name,
                 {.size_px = 0.9 * em, .color = kInk}, column_px - 3.0 * em);
  }
}

}  // namespace

Result<Picture> draw_cephalogram(const CephalogramDrawing& drawing) {
  const std::size_t pixels =
      std::size_t(std::max(drawing.columns, 0)) * std::size_t(std::max(drawing.rows, 0));
  if (pixels == 0 || !(drawing.pixel_mm > 0.0) ||
      (!drawing.water_mm.empty() && drawing.water_mm.size() != pixels))
    return fail(ErrorCode::kInvalidArgument,
                "the cephalogram has no pixels, or not one value each");
  const double em = letter_px(drawing.columns);
  const int top = int(std::ceil(3.0 * em));
  const double rows_px = 1.5 * em * std::ceil(double(drawing.tracings.size()) / 3.0);
  const Index height = Index(drawing.rows) + top + Index(std::ceil(4.6 * em + rows_px));
  if (std::max(Index(drawing.columns), height) > kMaxPictureSide)
    return fail(ErrorCode::kInvalidArgument, "the cephalogram is too large for a picture");
  Canvas canvas(drawing.columns, int(height), kPaper);
  const Rectangle panel{0.0, double(top), double(drawing.columns), double(drawing.rows)};
  if (!drawing.water_mm.empty()) canvas.place(grays_of(drawing), 0, top);
  for (const Tracing& tracing : drawing.tracings)
    canvas.strokes(tracing.lines, Eigen::Vector2d(panel.left, panel.top), panel, tracing.color,
                   0.12 * em);
  draw_points(canvas, drawing, panel, em);
  const double margin = em, width = double(drawing.columns) - 2.0 * em;
  canvas.write(margin, 1.8 * em, drawing.caption,
               {.size_px = 1.15 * em, .color = kInk, .bold = true}, width);
  const double below = panel.top + panel.height + 1.2 * em;
  draw_legend(canvas, drawing, margin, below, width, em);
  canvas.write(margin, below + rows_px + 0.6 * em, drawing.scale_note,
               {.size_px = 0.9 * em, .color = kInk}, width);
  const double baseline = double(height) - 0.8 * em;
  canvas.write(margin, baseline, kNotForClinicalUse, {.size_px = 0.9 * em, .color = kInk},
               0.6 * width);
  write_scale(canvas, margin + width, baseline - 0.35 * em, drawing.pixel_mm, drawing.columns, em);
  return canvas.picture();
}

}  // namespace lefort::report
