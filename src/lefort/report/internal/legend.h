/// \file
/// What explains a picture: a bar of colors, a bar of a known length.
#pragma once

#include <lefort/report/annotate.h>
#include <lefort/report/internal/canvas.h>

namespace lefort::report {

inline constexpr Rgb kInk{0.13, 0.15, 0.18};
inline constexpr Rgb kPaper{1.0, 1.0, 1.0};

/// The height of ordinary letters; all other lengths are told in it (em).
[[nodiscard]] double letter_px(int picture_width);

/// The colors of a scale in a bar at `place`, its title above, round numbers below.
void write_color_bar(Canvas& canvas, const Rectangle& place, const ColorBar& what, double em);

/// A bar of a round length, its right end at `right`.
void write_scale(Canvas& canvas, double right, double middle, double mm_per_pixel, int width,
                 double em);

}  // namespace lefort::report
