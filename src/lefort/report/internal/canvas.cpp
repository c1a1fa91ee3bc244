#include <lefort/core/check.h>
#include <lefort/report/internal/cairo_pixels.h>
#include <lefort/report/internal/canvas.h>
#include <lefort/report/internal/plain_text.h>

#include <cairo.h>
#include <fmt/format.h>

#include <algorithm>
#include <string>

namespace lefort::report {

struct Canvas::Context {
  cairo_surface_t* surface;
  cairo_t* cairo;
};

namespace {

void set_source(cairo_t* cairo, const Rgb& color, double opacity = 1.0) {
  cairo_set_source_rgba(cairo, color[0], color[1], color[2], opacity);
}

/// Text rendering that does not depend on the settings of the desktop.
void fix_font_rendering(cairo_t* cairo) {
  cairo_font_options_t* options = cairo_font_options_create();
  cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
  cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
  cairo_set_font_options(cairo, options);
  cairo_font_options_destroy(options);
}

}  // namespace

Canvas::Canvas(int width, int height, const Rgb& paper)
    : pixels_(std::size_t(width) * std::size_t(height)), width_(width), height_(height) {
  LEFORT_CHECK(width >= 1 && height >= 1 && width <= kMaxPictureSide && height <= kMaxPictureSide);
  cairo_surface_t* surface =
      cairo_image_surface_create_for_data(reinterpret_cast<unsigned char*>(pixels_.data()),
                                          CAIRO_FORMAT_RGB24, width, height, 4 * width);
  context_ = std::make_unique<Context>(Context{surface, cairo_create(surface)});
  fix_font_rendering(context_->cairo);
  set_source(context_->cairo, paper);
  cairo_paint(context_->cairo);
}

Canvas::~Canvas() {
  cairo_destroy(context_->cairo);
  cairo_surface_destroy(context_->surface);
}

void Canvas::place(const Picture& picture, int left, int top) {
  std::vector<std::uint32_t> words = cairo_pixels(picture);
  cairo_surface_t* source = cairo_image_surface_create_for_data(
      reinterpret_cast<unsigned char*>(words.data()), CAIRO_FORMAT_RGB24, picture.width,
      picture.height, 4 * picture.width);
  cairo_set_source_surface(context_->cairo, source, left, top);
  cairo_rectangle(context_->cairo, left, top, picture.width, picture.height);
  cairo_fill(context_->cairo);
  cairo_set_source_rgb(context_->cairo, 0.0, 0.0, 0.0);  // Releases `source`.
  cairo_surface_destroy(source);
}

void Canvas::fill(const Rectangle& area, const Rgb& color) {
  set_source(context_->cairo, color);
  cairo_rectangle(context_->cairo, area.left, area.top, area.width, area.height);
  cairo_fill(context_->cairo);
}

void Canvas::outline(const Rectangle& area, const Rgb& color, double line_px) {
  set_source(context_->cairo, color);
  cairo_set_line_width(context_->cairo, line_px);
  cairo_rectangle(context_->cairo, area.left, area.top, area.width, area.height);
  cairo_stroke(context_->cairo);
}

void Canvas::strokes(std::span<const geometry::Segment2> lines, const Eigen::Vector2d& shift,
                     const Rectangle& within, const Rgb& color, double line_px) {
  cairo_t* const cairo = context_->cairo;
  cairo_save(cairo);
  cairo_rectangle(cairo, within.left, within.top, within.width, within.height);
  cairo_clip(cairo);
  set_source(cairo, color);
  cairo_set_line_width(cairo, line_px);
  cairo_set_line_cap(cairo, CAIRO_LINE_CAP_ROUND);
  constexpr std::size_t kTogether = 1000;  // Lines per path; cairo is slow for long paths.
  for (std::size_t begin = 0; begin < lines.size(); begin += kTogether) {
    for (const geometry::Segment2& line :
         lines.subspan(begin, std::min(kTogether, lines.size() - begin))) {
      const Eigen::Vector2d from = line.from + shift, to = line.to + shift;
      cairo_move_to(cairo, from.x(), from.y());
      cairo_line_to(cairo, to.x(), to.y());
    }
    cairo_stroke(cairo);
  }
  cairo_restore(cairo);
}

void Canvas::write(double x, double y, std::string_view text, const TextStyle& style,
                   double max_width_px) {
  cairo_t* const cairo = context_->cairo;
  const std::string plain = plain_text(text);
  cairo_select_font_face(cairo, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                         style.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cairo, style.size_px);
  cairo_text_extents_t extents;
  cairo_text_extents(cairo, plain.c_str(), &extents);
  const double shrink = std::min(1.0, max_width_px / std::max(extents.x_advance, 1e-9));
  const double shift = style.align == Align::kLeft     ? 0.0
                       : style.align == Align::kCenter ? -0.5 * extents.x_advance
                                                       : -extents.x_advance;
  cairo_save(cairo);
  cairo_translate(cairo, x, y);
  cairo_rotate(cairo, -style.angle_rad);
  cairo_scale(cairo, shrink, shrink);
  cairo_move_to(cairo, shift, 0.0);
  set_source(cairo, style.color, style.opacity);
  cairo_show_text(cairo, plain.c_str());
  cairo_restore(cairo);
}

Result<Picture> Canvas::picture() const {
  cairo_surface_flush(context_->surface);
  const cairo_status_t status = cairo_status(context_->cairo);
  if (status != CAIRO_STATUS_SUCCESS)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("picture of {} x {} pixels cannot be drawn on: {}", width_, height_,
                            cairo_status_to_string(status)));
  return picture_from(pixels_, width_, height_);
}

}  // namespace lefort::report
