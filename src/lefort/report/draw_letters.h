/// \file
/// Letters alone, as a picture.
#pragma once

#include <lefort/core/error.h>
#include <lefort/report/picture.h>

#include <string_view>

namespace lefort::report {

/// Draws one line of text in black on white, in the font of annotate(), bold.
///
/// \param text     UTF-8.
/// \param size_px  of the font (em).
/// \returns the picture, cropped to the letters; or kInvalidArgument if nothing is drawn, as for
///   blanks, or the text is longer than 200 bytes, or size_px is not in [4, 200].
[[nodiscard]] Result<Picture> draw_letters(std::string_view text, double size_px);

}  // namespace lefort::report
