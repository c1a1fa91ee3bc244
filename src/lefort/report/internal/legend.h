/// \file
/// Color bars and scale bars of pictures.
#pragma once

#include <lefort/report/annotate.h>
#include <lefort/report/internal/canvas.h>

namespace lefort::report {

inline constexpr Rgb kInk{0.13, 0.15, 0.18};
inline constexpr Rgb kPaper{1.0, 1.0, 1.0};

/// \returns the font size; the unit (em) of all other lengths.
[[nodiscard]] double letter_px(int picture_width);

/// Draws a color bar in `area`, with its title above and round numbers below.
void write_color_bar(Canvas& canvas, const Rectangle& area, const ColorBar& what, double em);

/// Draws a scale bar of a round length, with its right end at `right`.
void write_scale(Canvas& canvas, double right, double middle, double mm_per_pixel, int width,
                 double em);

}  // namespace lefort::report
