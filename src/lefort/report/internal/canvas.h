/// \file
/// Drawing on a picture. Only this class, picture.cpp and sheet_pdf.cpp use cairo.
#pragma once

#include <lefort/core/error.h>
#include <lefort/geometry/iso_lines.h>
#include <lefort/report/color_map.h>
#include <lefort/report/picture.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

namespace lefort::report {

enum class Align { kLeft, kCenter, kRight };

struct TextStyle {
  double size_px = 16.0;
  Rgb color{0.13, 0.15, 0.18};
  double opacity = 1.0;
  Align align = Align::kLeft;
  bool bold = false;
  double angle_rad = 0.0;  ///< Counter-clockwise about the given point.
};

struct Rectangle {
  double left;
  double top;
  double width;
  double height;
};

/// Pixels with the origin at the top left; drawings are clipped at the edges.
class Canvas {
 public:
  /// \pre both sides in [1, kMaxPictureSide]
  Canvas(int width, int height, const Rgb& paper);
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  /// \pre check_picture(picture)
  void place(const Picture& picture, int left, int top);
  void fill(const Rectangle& area, const Rgb& color);
  void outline(const Rectangle& area, const Rgb& color, double line_px);

  /// Straight lines with round ends, displaced by `shift` and clipped by `within`.
  void strokes(std::span<const geometry::Segment2> lines, const Eigen::Vector2d& shift,
               const Rectangle& within, const Rgb& color, double line_px);

  /// One line of text on the baseline `y`, aligned at `x`; scaled down if it is wider than
  /// `max_width_px`.
  void write(double x, double y, std::string_view text, const TextStyle& style,
             double max_width_px);

  /// \returns the picture drawn so far.
  [[nodiscard]] Result<Picture> picture() const;

 private:
  struct Context;
  std::vector<std::uint32_t> pixels_;
  int width_;
  int height_;
  std::unique_ptr<Context> context_;
};

}  // namespace lefort::report
