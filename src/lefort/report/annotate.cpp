#include <lefort/core/version.h>
#include <lefort/report/annotate.h>
#include <lefort/report/internal/canvas.h>
#include <lefort/report/internal/legend.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lefort::report {

namespace {

constexpr Rgb kAlarm{0.72, 0.07, 0.10};

void write_sides(Canvas& canvas, const View& view, const Picture& picture, double em) {
  const Vec3 right_L = axes_of(view).right_L;
  const TextStyle left{.size_px = 1.9 * em, .color = kInk, .opacity = 0.85, .bold = true};
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
                 {.size_px = 1.5 * em, .color = kPaper, .align = Align::kCenter, .bold = true},
                 0.95 * picture.width);
  }
}

}  // namespace

Result<Picture> annotate(const Picture& picture, const Annotation& annotation) {
  LEFORT_TRY_VOID(check_picture(picture));
  if (annotation.color_bar) LEFORT_TRY_VOID(check_scale(annotation.color_bar->scale));
  if (annotation.view) LEFORT_TRY_VOID(check_view(*annotation.view));

  const double em = letter_px(picture.width);
  const double bar_rows_px = annotation.color_bar ? 5.2 * em : 0.0;
  const int height = picture.height + int(std::ceil(bar_rows_px + 2.6 * em));
  if (height > kMaxPictureSide)
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("picture would be {} pixels high, must be <= {}", height, kMaxPictureSide));
  Canvas canvas(picture.width, height, kPaper);
  canvas.place(picture, 0, 0);

  if (annotation.view) write_sides(canvas, *annotation.view, picture, em);
  if (!annotation.converged) write_alarm(canvas, picture, em);
  canvas.write(em, (annotation.converged ? 1.9 : 4.5) * em, annotation.caption,
               {.size_px = 1.15 * em, .color = kInk, .bold = true}, picture.width - 2.0 * em);
  if (annotation.color_bar) {
    const Rectangle bar{0.25 * picture.width, picture.height + 2.2 * em, 0.5 * picture.width, em};
    write_color_bar(canvas, bar, *annotation.color_bar, em);
  }
  const double baseline = height - em;
  canvas.write(em, baseline, kNotForClinicalUse, {.size_px = 0.9 * em, .color = kInk},
               (annotation.view ? 0.6 : 0.9) * picture.width);
  if (annotation.view)
    write_scale(canvas, picture.width - em, baseline - 0.35 * em,
                annotation.view->height_mm / picture.height, picture.width, em);
  return canvas.picture();
}

Result<Picture> side_by_side(std::span<const Picture> pictures,
                             std::span<const std::string> titles) {
  if (pictures.empty())
    return fail(ErrorCode::kInvalidArgument, "there are no pictures to place side by side");
  if (!titles.empty() && titles.size() != pictures.size())
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{} pictures have {} titles, must have one each or none",
                            pictures.size(), titles.size()));
  constexpr int kGap = 8;  // Pixels between pictures.
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
                fmt::format("row of pictures would have {} x {} pixels, each side must be <= {}",
                            width, tallest + title_px, kMaxPictureSide));
  Canvas canvas(int(width), tallest + title_px, kPaper);
  int left = 0;
  for (std::size_t n = 0; n < pictures.size(); ++n) {
    canvas.place(pictures[n], left, title_px);
    if (!titles.empty())
      canvas.write(left + 0.5 * pictures[n].width, 1.8 * em, titles[n],
                   {.size_px = 1.25 * em, .color = kInk, .align = Align::kCenter, .bold = true},
                   0.95 * pictures[n].width);
    left += pictures[n].width + kGap;
  }
  return canvas.picture();
}

}  // namespace lefort::report
