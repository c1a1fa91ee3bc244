#include <lefort/report/color_map.h>
#include <lefort/report/draw_slice.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace lefort::report::test_draw_slice {
namespace {

constexpr int kSize = 720;  // An em of ten pixels.
constexpr int kMargin = 22, kTop = 46;
constexpr double kBand = 3.0, kRadius = 20.0, kPixel = 0.1;

/// A circle of 20 mm in the middle of 72 x 72 mm, with a band of 3 mm.
SliceDrawing circle() {
  SliceDrawing drawing{.caption = "a circle",
                       .columns = kSize,
                       .rows = kSize,
                       .pixel_mm = kPixel,
                       .right_L = {1, 0, 0},
                       .down_L = {0, 0, -1},
                       .band_mm = kBand};
  for (int row = 0; row < kSize; ++row)
    for (int column = 0; column < kSize; ++column) {
      const double d = kPixel * std::hypot(column - 359.5, row - 359.5) - kRadius;
      const double infinity = std::numeric_limits<double>::infinity();
      drawing.distances_mm.push_back(std::abs(d) <= kBand ? d : std::copysign(infinity, d));
    }
  return drawing;
}

/// Color of the pixel `right_px` to the right of the center of the circle.
std::array<int, 3> color(const Picture& picture, double right_px) {
  const std::uint8_t* const rgb =
      picture.pixel(kMargin + int(std::lround(359.5 + right_px)), kTop + 360);
  return {rgb[0], rgb[1], rgb[2]};
}
int darkness(const std::array<int, 3>& rgb) { return 765 - rgb[0] - rgb[1] - rgb[2]; }

TEST(DrawSlice, InsideIsBlueOutsideIsRedAndBeyondTheBandGray) {
  const Picture picture = draw_slice(circle()).value();
  EXPECT_EQ(picture.width, kSize + 2 * kMargin);
  EXPECT_GT(picture.height, kSize + kTop + 100);
  const auto inside = color(picture, 185), outside = color(picture, 215);
  EXPECT_GT(inside[2], inside[0] + 40);
  EXPECT_GT(outside[0], outside[2] + 40);
  const auto far_inside = color(picture, 60), far_outside = color(picture, 300);
  for (const auto& gray : {far_inside, far_outside})
    EXPECT_LT(
        *std::max_element(gray.begin(), gray.end()) - *std::min_element(gray.begin(), gray.end()),
        10);
  EXPECT_GT(darkness(far_inside), darkness(far_outside) + 100);
}

TEST(DrawSlice, ZeroIsAThickLineAndStepsAreThinOnes) {
  const Picture picture = draw_slice(circle()).value();
  // Sum over the pixels within 3 of a position of how much darker they are than those further away.
  const auto ink = [&](int at) {
    double sum = 0.0;
    for (int off = -3; off <= 3; ++off)
      sum += darkness(color(picture, at + off)) -
             0.5 * (darkness(color(picture, at - 4)) + darkness(color(picture, at + 4)));
    return sum;
  };
  for (const int step : {190, 210}) {
    EXPECT_GT(ink(step), 100.0) << step;
    EXPECT_GT(ink(200), 3.0 * ink(step)) << step;
  }
  for (const int between : {195, 205}) EXPECT_LT(ink(between), 30.0) << between;
}

TEST(DrawSlice, StepAddsContourLines) {
  SliceDrawing drawing = circle();
  drawing.step_mm = 3.0;  // Only at the edge of the band.
  const Picture without = draw_slice(drawing).value();
  drawing.step_mm = 1.0;
  const Picture with = draw_slice(drawing).value();
  for (const double at : {180.0, 190.0, 210.0, 220.0}) {
    int maximum = 0;
    for (int off = -1; off <= 1; ++off)
      maximum =
          std::max(maximum, darkness(color(with, at + off)) - darkness(color(without, at + off)));
    EXPECT_GT(maximum, 40) << at;
  }
  EXPECT_EQ(color(with, 185), color(without, 185));
}

TEST(DrawSlice, ColorBarHasTheColorsOfThePanel) {
  const ColorScale scale{ColorMap::kDiverging, -kBand, kBand};
  for (const int columns : {kSize, kSize - 1, kSize - 2, kSize - 3}) {
    SliceDrawing drawing{.columns = columns, .rows = 100, .band_mm = kBand};
    drawing.distances_mm.assign(std::size_t(columns) * 100, 0.5);
    const Picture picture = draw_slice(drawing).value();
    const auto is_in_legend = [&](double distance_mm) {
      const Rgb wanted = scale.color(distance_mm);
      for (int row = kTop + 100; row < picture.height; ++row)
        for (int column = 0; column < picture.width; ++column) {
          double maximum = 0.0;
          for (int c = 0; c < 3; ++c)
            maximum = std::max(
                maximum, std::abs(picture.pixel(column, row)[c] - 255.0 * wanted[std::size_t(c)]));
          if (maximum < 3.0) return true;
        }
      return false;
    };
    for (const double distance_mm : {-2.95, -1.5, 1.0, 2.95})
      EXPECT_TRUE(is_in_legend(distance_mm)) << columns << ", " << distance_mm;
  }
}

TEST(DrawSlice, UnknownIsHatched) {
  SliceDrawing drawing = circle();
  for (double& d : drawing.distances_mm)
    if (d > kBand) d = std::numeric_limits<double>::quiet_NaN();
  const Picture picture = draw_slice(drawing).value();
  std::set<std::array<int, 3>> colors;
  for (int at = 280; at < 340; ++at) colors.insert(color(picture, at));
  EXPECT_EQ(colors.size(), 2U);
}

TEST(DrawSlice, OutlineIsDrawnOnTheZeroLine) {
  SliceDrawing drawing = circle();
  drawing.outline = {{{559.5, -500.0}, {559.5, 1500.0}}};  // From beyond the panel to beyond it.
  const Picture plain = draw_slice(circle()).value(), picture = draw_slice(drawing).value();
  const auto green = color(picture, 200);
  EXPECT_GT(green[1], green[0] + 40);
  // It is not drawn above or below the panel, except in the legend.
  const int column = kMargin + 559;
  for (int row = 0; row < kTop - 1; ++row)
    EXPECT_TRUE(std::equal(picture.pixel(column, row), picture.pixel(column, row) + 3,
                           plain.pixel(column, row)));
}

TEST(DrawSlice, LettersOfThePatientsSidesSurroundThePanel) {
  // The same slice seen from the other side: only the letters to the left and right change.
  SliceDrawing mirrored = circle();
  mirrored.right_L = {-1, 0, 0};
  const Picture a = draw_slice(circle()).value(), b = draw_slice(mirrored).value();
  const auto differs = [&](int left, int top, int right, int bottom) {
    for (int row = top; row < bottom; ++row)
      for (int column = left; column < right; ++column)
        if (!std::equal(a.pixel(column, row), a.pixel(column, row) + 3, b.pixel(column, row)))
          return true;
    return false;
  };
  const int right = kMargin + kSize, bottom = kTop + kSize;
  EXPECT_TRUE(differs(0, kTop, kMargin, bottom));
  EXPECT_TRUE(differs(right, kTop, a.width, bottom));
  EXPECT_FALSE(differs(kMargin, 0, right, kTop));
  EXPECT_FALSE(differs(kMargin, bottom, right, a.height));
}

TEST(DrawSlice, DrawsSmallPictures) {
  for (const int size : {1, 2, 30}) {
    SliceDrawing drawing{.columns = size, .rows = size};
    drawing.distances_mm.assign(std::size_t(size * size), 0.25);
    EXPECT_TRUE(draw_slice(drawing));
  }
}

TEST(DrawSlice, RejectsInconsistentNumbers) {
  const auto refused = [](const SliceDrawing& drawing) {
    const auto picture = draw_slice(drawing);
    return !picture && picture.error().code == ErrorCode::kInvalidArgument;
  };
  const auto with = [](auto change) {
    SliceDrawing drawing = circle();
    change(drawing);
    return drawing;
  };
  EXPECT_FALSE(refused(circle()));
  EXPECT_TRUE(refused(SliceDrawing{}));
  EXPECT_TRUE(refused(with([](auto& d) { d.rows = kSize - 1; })));
  EXPECT_TRUE(refused(with([](auto& d) { d.pixel_mm = 0.0; })));
  EXPECT_TRUE(refused(with([](auto& d) { d.band_mm = -1.0; })));
  EXPECT_TRUE(refused(with([](auto& d) { d.band_mm = std::nan(""); })));
  EXPECT_TRUE(refused(with([](auto& d) { d.step_mm = -1.0; })));
  EXPECT_TRUE(refused(with([](auto& d) { d.step_mm = 1e-9; })));
  SliceDrawing wide{.columns = kMaxPictureSide, .rows = 1};
  wide.distances_mm.assign(kMaxPictureSide, 0.0);
  EXPECT_TRUE(refused(wide));
}

}  // namespace
}  // namespace lefort::report::test_draw_slice
