#include <lefort/report/annotate.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

namespace lefort::report::test_annotate {
namespace {

Picture gray(int width, int height) {
  Picture picture{width, height,
                  std::vector<std::uint8_t>(4 * std::size_t(width) * std::size_t(height), 200)};
  for (std::size_t i = 3; i < picture.rgba.size(); i += 4) picture.rgba[i] = 255;
  return picture;
}

/// Number of pixels of [left, right) x [top, bottom) for which `is` is true.
template <class Predicate>
long count(const Picture& picture, int left, int top, int right, int bottom, const Predicate& is) {
  long found = 0;
  for (int row = top; row < bottom; ++row)
    for (int column = left; column < right; ++column)
      found += is(picture.pixel(column, row)) ? 1 : 0;
  return found;
}

bool is_dark(const std::uint8_t* rgba) { return rgba[0] < 170 && rgba[1] < 170 && rgba[2] < 170; }
bool is_red(const std::uint8_t* rgba) { return rgba[0] > 140 && rgba[1] < 60 && rgba[2] < 60; }

TEST(Annotate, EveryPictureHasTheClinicalUseWarning) {
  const Picture plain = gray(600, 400);
  const Picture annotated = annotate(plain, {}).value();
  EXPECT_EQ(annotated.width, plain.width);
  ASSERT_GT(annotated.height, plain.height);
  EXPECT_GT(count(annotated, 0, plain.height, 300, annotated.height, is_dark), 100);
}

TEST(Annotate, WithoutTextThePictureItselfIsUnchanged) {
  const Picture plain = gray(600, 400);
  const Picture annotated = annotate(plain, {}).value();
  EXPECT_TRUE(std::equal(plain.rgba.begin(), plain.rgba.end(), annotated.rgba.begin()));
}

TEST(Annotate, ScaleBarHasItsLength) {
  // 0.5 mm per pixel; the longest round length within 16 % of 600 pixels, 48 mm, is 20 mm.
  const Picture plain = gray(600, 400);
  const Picture annotated = annotate(plain, {.view = View{.height_mm = 200.0}}).value();
  int longest = 0;
  for (int row = plain.height; row < annotated.height; ++row) {
    int run = 0;
    for (int column = 0; column < 600; ++column) {
      run = annotated.pixel(column, row)[0] < 160 ? run + 1 : 0;
      longest = std::max(longest, run);
    }
  }
  EXPECT_NEAR(longest, 40, 2);
}

TEST(Annotate, LettersOfThePatientsSidesAreInTheLowerCorners) {
  const Picture plain = gray(600, 400);
  const auto dark_in = [&](const View& view, int left, int right) {
    return count(annotate(plain, {.view = view}).value(), left, 350, right, 400, is_dark);
  };
  const View front{};
  const View behind{.direction_L = Vec3(0.0, -1.0, 0.0)};
  EXPECT_GT(dark_in(front, 0, 60), 10);
  EXPECT_GT(dark_in(front, 540, 600), 10);
  // R has more dark pixels than L, so the letters can be distinguished; from behind they swap.
  EXPECT_GT(dark_in(front, 0, 60), dark_in(front, 540, 600) + 10);
  EXPECT_LT(dark_in(behind, 0, 60), dark_in(behind, 540, 600) - 10);
}

TEST(Annotate, ColorBarHasTheColorsOfItsScale) {
  const Picture plain = gray(600, 400);
  const ColorBar bar{{ColorMap::kDiverging, -3.0, 3.0}, "change", "mm"};
  const Picture annotated = annotate(plain, {.color_bar = bar}).value();
  const auto has = [&](const Rgb& color) {
    return count(annotated, 0, plain.height, 600, annotated.height, [&](const auto* rgba) {
             return std::abs(rgba[0] - 255.0 * color[0]) < 4.0 &&
                    std::abs(rgba[1] - 255.0 * color[1]) < 4.0 &&
                    std::abs(rgba[2] - 255.0 * color[2]) < 4.0;
           }) > 3;
  };
  for (const double value : {-2.9, -1.5, 0.0, 1.5, 2.9})
    EXPECT_TRUE(has(bar.scale.color(value))) << value;
  EXPECT_GT(annotated.height, annotate(plain, {}).value().height);
}

TEST(Annotate, UnconvergedPicturesHaveRedBands) {
  const Picture plain = gray(600, 400);
  const auto red_in = [&](bool converged, int top, int bottom) {
    return count(annotate(plain, {.converged = converged}).value(), 0, top, 600, bottom, is_red);
  };
  EXPECT_EQ(red_in(true, 0, 400), 0);
  EXPECT_GT(red_in(false, 0, 40), 600 * 8);
  EXPECT_GT(red_in(false, 150, 250), 600 * 8);
}

TEST(Annotate, HostileTextDoesNotFail) {
  const Picture plain = gray(300, 200);
  for (const std::string& caption :
       {std::string("\xff\xfe broken \x80 bytes"), std::string("line\nbreak\tand\0zero", 19),
        std::string(20'000, 'W'), std::string("\xf0\x9f\x98\x80 \xd7\xa9\xd7\x9c")}) {
    const auto annotated = annotate(plain, {.caption = caption});
    ASSERT_TRUE(annotated) << annotated.error().message;
    EXPECT_EQ(annotated->width, 300);
  }
}

TEST(Annotate, TinyPicturesAndExtremeScalesAreAnnotated) {
  EXPECT_TRUE(annotate(gray(1, 1), {.caption = "a", .view = View{}, .converged = false}));
  for (const double height_mm : {1e-6, 1e9})
    EXPECT_TRUE(annotate(gray(64, 64), {.view = View{.height_mm = height_mm}}));
  for (const auto& [low, high] : {std::pair{-1e300, 1e300}, {1.0, 1.0 + 1e-15}, {0.0, 1e-300}}) {
    const ColorBar bar{{ColorMap::kSequential, low, high}, "t", ""};
    EXPECT_TRUE(annotate(gray(64, 64), {.color_bar = bar})) << low << " to " << high;
  }
}

TEST(Annotate, RejectsInvalidAnnotations) {
  const Picture plain = gray(64, 64);
  EXPECT_EQ(annotate({3, 3, {}}, {}).error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(annotate(plain, {.view = View{.height_mm = 0.0}}).error().code,
            ErrorCode::kInvalidArgument);
  const ColorBar bar{{ColorMap::kSequential, 1.0, 0.0}, "t", ""};
  EXPECT_EQ(annotate(plain, {.color_bar = bar}).error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(annotate(gray(1, kMaxPictureSide), {}).error().code, ErrorCode::kInvalidArgument);
}

TEST(SideBySide, KeepsEveryPictureUnderItsTitle) {
  Picture red = gray(100, 80);
  for (std::size_t i = 0; i < red.rgba.size(); i += 4) red.rgba[i + 1] = red.rgba[i + 2] = 0;
  const std::vector<Picture> pair{gray(120, 60), red};
  const std::vector<std::string> titles{"before", "after"};
  const Picture row = side_by_side(pair, titles).value();
  EXPECT_GT(row.height, 80);
  EXPECT_GE(row.width, 220);
  EXPECT_EQ(count(row, 0, 0, 120, row.height, is_red), 0);
  EXPECT_EQ(count(row, 120, 0, row.width, row.height, is_red), 100 * 80);
  EXPECT_EQ(side_by_side(pair, {})->height, 80);
}

TEST(SideBySide, RejectsNoPicturesAndMismatchedTitles) {
  const std::vector<std::string> one_title{"before"};
  const std::vector<Picture> pair{gray(10, 10), gray(10, 10)};
  EXPECT_EQ(side_by_side({}, {}).error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(side_by_side(pair, one_title).error().code, ErrorCode::kInvalidArgument);
  const std::vector<Picture> wide(3, gray(6000, 1));
  EXPECT_EQ(side_by_side(wide, {}).error().code, ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace lefort::report::test_annotate
