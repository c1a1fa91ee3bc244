#include <lefort/core/version.h>
#include <lefort/report/draw_slice.h>
#include <lefort/report/internal/canvas.h>
#include <lefort/report/internal/legend.h>
#include <lefort/report/internal/ticks.h>
#include <lefort/report/view.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace lefort::report {

namespace {

constexpr Rgb kOutside{0.93, 0.93, 0.92};
constexpr Rgb kInside{0.70, 0.71, 0.73};
constexpr Rgb kUnknown{0.98, 0.96, 0.90};
constexpr Rgb kHatch{0.70, 0.66, 0.58};
constexpr Rgb kOutline{0.36, 0.92, 0.28};  ///< Visible on the zero line, too.
constexpr Rgb kStepLine{0.33, 0.35, 0.38};
constexpr int kStepsInBand = 3;
constexpr int kMaxSteps = 1000;  ///< Contour lines on each side; more would be illegible.

Rgb hatched(int column, int row, double em) {
  const double period = 0.6 * em;
  return std::fmod(column + row, period) < 0.2 * period ? kHatch : kUnknown;
}

Rgb color_of(double distance_mm, const ColorScale& scale, int column, int row, double em) {
  if (std::isnan(distance_mm)) return hatched(column, row, em);
  if (std::isinf(distance_mm)) return distance_mm > 0.0 ? kOutside : kInside;
  return scale.color(distance_mm);
}

Picture colors_of(const SliceDrawing& drawing, const ColorScale& scale, double em) {
  Picture picture{drawing.columns, drawing.rows, {}};
  picture.rgba.reserve(4 * drawing.distances_mm.size());
  for (int row = 0; row < drawing.rows; ++row)
    for (int column = 0; column < drawing.columns; ++column) {
      const double d =
          drawing
              .distances_mm[std::size_t(row) * std::size_t(drawing.columns) + std::size_t(column)];
      for (const double fraction : color_of(d, scale, column, row, em))
        picture.rgba.push_back(std::uint8_t(std::lround(255.0 * fraction)));
      picture.rgba.push_back(255);
    }
  return picture;
}

Result<void> check_drawing(const SliceDrawing& drawing) {
  const auto refuse = [](std::string message) {
    return fail(ErrorCode::kInvalidArgument, std::move(message));
  };
  if (drawing.columns < 1 || drawing.rows < 1 ||
      drawing.distances_mm.size() != std::size_t(drawing.columns) * std::size_t(drawing.rows))
    return refuse(fmt::format("slice of {} x {} pixels has {} distances, must have one each",
                              drawing.columns, drawing.rows, drawing.distances_mm.size()));
  for (const double length : {drawing.pixel_mm, drawing.band_mm})
    if (!(length > 0.0 && std::isfinite(length)))
      return refuse(fmt::format("slice has a pixel of {} mm and a band of {} mm, both must be > 0",
                                drawing.pixel_mm, drawing.band_mm));
  if (!(drawing.step_mm >= 0.0) ||
      (drawing.step_mm > 0.0 && drawing.band_mm / drawing.step_mm > kMaxSteps))
    return refuse(fmt::format("slice has contour lines every {} mm, must be 0 or at least {} mm",
                              drawing.step_mm, drawing.band_mm / kMaxSteps));
  return {};
}

/// Writes the letters of the patient's sides into the margin.
void write_sides(Canvas& canvas, const SliceDrawing& drawing, const Rectangle& panel, double em) {
  const TextStyle style{.size_px = 1.6 * em, .color = kInk, .align = Align::kCenter, .bold = true};
  const double middle_x = panel.left + 0.5 * panel.width,
               middle_y = panel.top + 0.5 * panel.height + 0.55 * em,
               right = panel.left + panel.width, bottom = panel.top + panel.height;
  const auto letters = [&](double x, double y, const Vec3& side_L) {
    canvas.write(x, y, orientation_letters(side_L), style, 2.0 * em);
  };
  letters(panel.left - 1.1 * em, middle_y, -drawing.right_L);
  letters(right + 1.1 * em, middle_y, drawing.right_L);
  letters(middle_x, panel.top - 0.5 * em, -drawing.down_L);
  letters(middle_x, bottom + 1.7 * em, drawing.down_L);
}

/// One sample with its explanation.
struct LegendEntry {
  std::string text;
  Rgb fill;
  Rgb line;
  double line_px;
};

/// Writes the entries in rows of kColumns. \returns the height of the legend.
double write_legend(Canvas& canvas, const std::vector<LegendEntry>& entries, double left,
                    double top, double width, double em) {
  constexpr int kColumns = 3;
  const double column_px = width / kColumns, swatch_px = 2.2 * em, row_px = 1.7 * em;
  for (std::size_t n = 0; n < entries.size(); ++n) {
    const LegendEntry& entry = entries[n];
    const double x = left + column_px * double(n % kColumns),
                 y = top + row_px * double(n / kColumns);
    const Rectangle swatch{x, y, swatch_px, em};
    canvas.fill(swatch, entry.fill);
    if (entry.fill == kUnknown)
      for (int row = 0; row < int(em); ++row)
        for (int column = 0; column < int(swatch_px); ++column)
          canvas.fill({x + column, y + row, 1.0, 1.0}, hatched(column, row, em));
    if (entry.line_px > 0.0) {
      const geometry::Segment2 line{{x, y + 0.5 * em}, {x + swatch_px, y + 0.5 * em}};
      canvas.strokes({&line, 1}, Eigen::Vector2d::Zero(), swatch, entry.line, entry.line_px);
    } else {
      canvas.outline(swatch, kStepLine, 0.04 * em);
    }
    canvas.write(x + swatch_px + 0.5 * em, y + 0.85 * em, entry.text,
                 {.size_px = 0.9 * em, .color = kInk}, column_px - swatch_px - em);
  }
  const std::size_t rows = (entries.size() + kColumns - 1) / kColumns;
  return row_px * double(rows);
}

}  // namespace

Result<Picture> draw_slice(const SliceDrawing& drawing) {
  LEFORT_TRY_VOID(check_drawing(drawing));
  const double em = letter_px(drawing.columns);
  const ColorScale scale{ColorMap::kDiverging, -drawing.band_mm, drawing.band_mm};
  const double step_mm =
      drawing.step_mm > 0.0 ? drawing.step_mm : round_below(drawing.band_mm / kStepsInBand);
  const double zero_px = 0.26 * em, step_px = 0.07 * em, outline_px = 0.1 * em;

  const int margin = int(std::ceil(2.2 * em)), top = int(std::ceil(4.6 * em));
  const double below_px = 14.0 * em;
  const Index width = Index(drawing.columns) + 2 * margin,
              height = Index(drawing.rows) + top + int(std::ceil(below_px));
  if (std::max(width, height) > kMaxPictureSide)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("picture would have {} x {} pixels, each side must be <= {}", width,
                            height, kMaxPictureSide));
  Canvas canvas(int(width), int(height), kPaper);
  const Rectangle panel{double(margin), double(top), double(drawing.columns), double(drawing.rows)};
  canvas.place(colors_of(drawing, scale, em), margin, top);

  // The center of the first pixel.
  const Eigen::Vector2d first(panel.left + 0.5, panel.top + 0.5);
  const auto draw_level = [&](double level, const Rgb& color, double line_px) {
    canvas.strokes(geometry::iso_lines(drawing.distances_mm, drawing.columns, level), first, panel,
                   color, line_px);
  };
  for (int n = 1; n * step_mm < drawing.band_mm; ++n)
    for (const double side : {-n * step_mm, n * step_mm}) draw_level(side, kStepLine, step_px);
  draw_level(0.0, kInk, zero_px);
  canvas.strokes(drawing.outline, first, panel, kOutline, outline_px);
  canvas.outline(panel, kStepLine, 0.06 * em);

  write_sides(canvas, drawing, panel, em);
  canvas.write(margin, 1.7 * em, drawing.caption,
               {.size_px = 1.15 * em, .color = kInk, .bold = true}, double(width) - 2.0 * margin);

  const double bottom = panel.top + panel.height;
  write_color_bar(canvas, {0.25 * double(width), bottom + 4.4 * em, 0.5 * double(width), em},
                  {scale, "signed distance: negative inside, positive outside", "mm"}, em);
  std::vector<LegendEntry> legend = {
      {"zero: surface of the field", kPaper, kInk, zero_px},
      {fmt::format("contour lines, every {} mm", tick_text(step_mm)), kPaper, kStepLine, step_px}};
  if (!drawing.outline.empty())
    legend.push_back({drawing.outline_name, kPaper, kOutline, outline_px});
  legend.push_back({"outside, beyond the band", kOutside, kInk, 0.0});
  legend.push_back({"inside, beyond the band", kInside, kInk, 0.0});
  legend.push_back({"unknown", kUnknown, kInk, 0.0});
  write_legend(canvas, legend, margin, bottom + 8.2 * em, double(width) - 2.0 * margin, em);

  const double baseline = double(height) - em;
  canvas.write(margin, baseline, kNotForClinicalUse, {.size_px = 0.9 * em, .color = kInk},
               0.6 * double(width));
  write_scale(canvas, double(width) - margin, baseline - 0.35 * em, drawing.pixel_mm,
              drawing.columns, em);
  return canvas.picture();
}

}  // namespace lefort::report
