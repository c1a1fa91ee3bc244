#include <lefort/report/draw_letters.h>
#include <lefort/report/internal/canvas.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace lefort::report {
namespace {

/// The smallest part with all pixels that are not white; empty if there is none.
Picture cropped(const Picture& picture) {
  int left = picture.width, right = -1, top = picture.height, bottom = -1;
  for (int row = 0; row < picture.height; ++row)
    for (int column = 0; column < picture.width; ++column)
      if (picture.pixel(column, row)[0] < 255) {
        left = std::min(left, column);
        right = std::max(right, column);
        top = std::min(top, row);
        bottom = std::max(bottom, row);
      }
  if (right < 0) return {};
  Picture part{right - left + 1, bottom - top + 1, {}};
  part.rgba.reserve(std::size_t(part.width) * std::size_t(part.height) * 4);
  for (int row = top; row <= bottom; ++row) {
    const std::uint8_t* const first = picture.pixel(left, row);
    part.rgba.insert(part.rgba.end(), first, first + 4 * std::ptrdiff_t(part.width));
  }
  return part;
}

}  // namespace

Result<Picture> draw_letters(std::string_view text, double size_px) {
  constexpr std::size_t kMaxBytes = 200;
  constexpr double kMaxSize_px = 200.0, kMinSize_px = 4.0;
  if (text.size() > kMaxBytes || !(size_px >= kMinSize_px && size_px <= kMaxSize_px))
    return fail(ErrorCode::kInvalidArgument, "the text is too long, or its size out of range");
  const auto height = int(std::ceil(3.0 * size_px));
  // No letter is wider than 1.5 em.
  const auto width = int(std::ceil(1.5 * size_px * double(text.size() + 2)));
  Canvas canvas(std::min(width, kMaxPictureSide), height, {1.0, 1.0, 1.0});
  canvas.write(size_px, 2.0 * size_px, text,
               {.size_px = size_px, .color = {0.0, 0.0, 0.0}, .bold = true}, double(width));
  LEFORT_TRY(const Picture drawn, canvas.picture());
  Picture letters = cropped(drawn);
  if (letters.width == 0)
    return fail(ErrorCode::kInvalidArgument, "the text has no visible letter");
  return letters;
}

}  // namespace lefort::report
