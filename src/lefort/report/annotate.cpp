#include <lefort/core/version.h>
#include <lefort/report/annotate.h>
#include <lefort/report/internal/canvas.h>
#include <lefort/report/internal/ticks.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lefort::report {

namespace {

constexpr Rgb kInk{0.13, 0.15, 0.18};
constexpr Rgb kPaper{1.0, 1.0, 1.0};
constexpr Rgb kAlarm{0.72, 0.07, 0.10};

/// The height of ordinary letters; all other lengths are told in it.
double letter_px(int picture_width) { return std::clamp(picture_width / 72.0, 9.0, 48.0); }

void write_colour_bar(Canvas& canvas, const Rectangle& bar, const ColourBar& what, double em) {
  const int columns = int(std::ceil(bar.width));
  for (int x = 0; x < columns; ++x)
    canvas.fill({bar.left + x, bar.top, std::min(1.0, bar.width - x), bar.height},
                colour_at(what.scale.map, (x + 0.5) / bar.width));
  canvas.outline(bar, kInk, 0.06 * em);
  const std::string title =
      what.unit.empty() ? what.title : fmt::format("{} [{}]", what.title, what.unit);
  canvas.write(bar.left + 0.5 * bar.width, bar.top - 0.5 * em, title,
               {.size_px = em, .colour = kInk, .align = Align::kCentre}, 1.6 * bar.width);
  const double low = what.scale.low;
  for (const double tick : ticks(low, what.scale.high, 5)) {
    const double x = bar.left + bar.width * (tick - low) / (what.scale.high - low);
    canvas.fill({x - 0.03 * em, bar.top + bar.height, 0.06 * em, 0.35 * em}, kInk);
    canvas.write(x, bar.top + bar.height + 1.35 * em, tick_text(tick),
                 {.size_px = 0.9 * em, .colour = kInk, .align = Align::kCentre}, 4.0 * em);
  }
}

/// A bar of a round length, its right end at `right`.
void write_scale(Canvas& canvas, double right, double middle, double mm_per_pixel, int width,
                 double em) {
  const double length_mm = round_below(0.16 * width * mm_per_pixel);
  const double length_px = length_mm / mm_per_pixel;
  const double left = right - length_px;
  canvas.fill({left, middle - 0.07 * em, length_px, 0.14 * em}, kInk);
  for (const double end : {left, right})
    canvas.fill({end - 0.05 * em, middle - 0.4 * em, 0.1 * em, 0.8 * em}, kInk);
  canvas.write(left - 0.6 * em, middle + 0.35 * em, fmt::format("{} mm", tick_text(length_mm)),
               {.size_px = 0.9 * em, .colour = kInk, .align = Align::kRight}, 0.2 * width);
}

void write_sides(Canvas& canvas, const View& view, const Picture& picture, double em) {
  const Vec3 right_L = axes_of(view).right_L;
  const TextStyle left{.size_px = 1.9 * em, .colour = kInk, .opacity = 0.85, .bold = true};
  TextStyle right = left;
  right.align = Align::kRight;
  const double baseline = picture.height - em;
  canvas.write(em, baseline, orientation_letters(-right_L), left, 4.0 * em);
  canvas.write(picture.width - em, baseline, orientation_letters(right_L), right, 4.0 * em);
}

void write_alarm(Canvas& canvas, const Picture& picture, double em) {
  const double height = 2.6 * em;
  for (const double top : {0.0, 0.5 * (picture.height - height)}) {
    canvas.fill({0.0, top, double(picture.width), height}, kAlarm);
    canvas.write(0.5 * picture.width, top + 1.8 * em, kNotConvergedBanner,
                 {.size_px = 1.5 * em, .colour = kPaper, .align = Align::kCentre, .bold = true},
                 0.95 * picture.width);
  }
}

}  // namespace

Result<Picture> annotate(const Picture& picture, const Annotation& annotation) {
  LEFORT_TRY_VOID(check_picture(picture));
  if (annotation.colour_bar) LEFORT_TRY_VOID(check_scale(annotation.colour_bar->scale));
  if (annotation.view) LEFORT_TRY_VOID(check_view(*annotation.view));

  const double em = letter_px(picture.width);
  const double bar_rows_px = annotation.colour_bar ? 5.2 * em : 0.0;
  const int height = picture.height + int(std::ceil(bar_rows_px + 2.6 * em));
  if (height > kMaxPictureSide)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("picture gets {} pixels high, must be <= {}", height, kMaxPictureSide));
  Canvas canvas(picture.width, height, kPaper);
  canvas.place(picture, 0, 0);

  if (annotation.view) write_sides(canvas, *annotation.view, picture, em);
  if (!annotation.converged) write_alarm(canvas, picture, em);
  canvas.write(em, (annotation.converged ? 1.9 : 4.5) * em, annotation.caption,
               {.size_px = 1.15 * em, .colour = kInk, .bold = true}, picture.width - 2.0 * em);
  if (annotation.colour_bar) {
    const Rectangle bar{0.25 * picture.width, picture.height + 2.2 * em, 0.5 * picture.width, em};
    write_colour_bar(canvas, bar, *annotation.colour_bar, em);
  }
  const double baseline = height - em;
  canvas.write(em, baseline, kNotForClinicalUse, {.size_px = 0.9 * em, .colour = kInk},
               (annotation.view ? 0.6 : 0.9) * picture.width);
  if (annotation.view)
    write_scale(canvas, picture.width - em, baseline - 0.35 * em,
                annotation.view->height_mm / picture.height, picture.width, em);
  return canvas.picture();
}

Result<Picture> side_by_side(std::span<const Picture> pictures,
                             std::span<const std::string> titles) {
  if (pictures.empty())
    return fail(ErrorCode::kInvalidArgument, "there is no picture to put side by side");
  if (!titles.empty() && titles.size() != pictures.size())
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{} pictures have {} titles, must have one each or none",
                            pictures.size(), titles.size()));
  constexpr int kGap = 8;
  Index width = -kGap;
  int tallest = 0;
  for (const Picture& picture : pictures) {
    LEFORT_TRY_VOID(check_picture(picture));
    width += picture.width + kGap;
    tallest = std::max(tallest, picture.height);
  }
  const double em = letter_px(pictures.front().width);
  const int title_px = titles.empty() ? 0 : int(std::ceil(2.6 * em));
  if (width > kMaxPictureSide || tallest + title_px > kMaxPictureSide)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("row of pictures gets {} x {} pixels, each side must be <= {}", width,
                            tallest + title_px, kMaxPictureSide));
  Canvas canvas(int(width), tallest + title_px, kPaper);
  int left = 0;
  for (std::size_t n = 0; n < pictures.size(); ++n) {
    canvas.place(pictures[n], left, title_px);
    if (!titles.empty())
      canvas.write(left + 0.5 * pictures[n].width, 1.8 * em, titles[n],
                   {.size_px = 1.25 * em, .colour = kInk, .align = Align::kCentre, .bold = true},
                   0.95 * pictures[n].width);
    left += pictures[n].width + kGap;
  }
  return canvas.picture();
}

}  // namespace lefort::report
