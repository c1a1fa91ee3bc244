#include <lefort/report/color_map.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace lefort::report::test_color_map {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// CIE lightness L*, 0 to 100.
double lightness(const Rgb& color) {
  const auto decode = [](double c) {
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
  };
  const double y =
      0.2126 * decode(color[0]) + 0.7152 * decode(color[1]) + 0.0722 * decode(color[2]);
  return y > 0.008856 ? 116.0 * std::cbrt(y) - 16.0 : 903.3 * y;
}

TEST(ColorMap, EndsEqualThePublishedTables) {
  EXPECT_EQ(color_at(ColorMap::kSequential, 0.0), (Rgb{252 / 255.0, 253 / 255.0, 191 / 255.0}));
  EXPECT_EQ(color_at(ColorMap::kDiverging, 0.0), (Rgb{59 / 255.0, 76 / 255.0, 192 / 255.0}));
  EXPECT_EQ(color_at(ColorMap::kDiverging, 1.0), (Rgb{180 / 255.0, 4 / 255.0, 38 / 255.0}));
}

TEST(ColorMap, ClampsBeyondItsEnds) {
  for (const ColorMap map : {ColorMap::kSequential, ColorMap::kDiverging}) {
    EXPECT_EQ(color_at(map, -kInfinity), color_at(map, 0.0));
    EXPECT_EQ(color_at(map, 7.0), color_at(map, 1.0));
  }
}

TEST(ColorMap, NotANumberIsGray) {
  EXPECT_EQ(color_at(ColorMap::kSequential, kNan), kMissingColor);
  EXPECT_EQ((ColorScale{ColorMap::kDiverging, -1.0, 1.0}.color(kNan)), kMissingColor);
}

TEST(ColorMap, SequentialDarkensInEvenSteps) {
  const double whole = lightness(color_at(ColorMap::kSequential, 0.0)) -
                       lightness(color_at(ColorMap::kSequential, 1.0));
  EXPECT_GT(whole, 50.0);
  for (int i = 0; i < 20; ++i) {
    const double step = lightness(color_at(ColorMap::kSequential, i / 20.0)) -
                        lightness(color_at(ColorMap::kSequential, (i + 1) / 20.0));
    EXPECT_NEAR(step, whole / 20.0, 0.35 * whole / 20.0) << "from fraction " << i / 20.0;
  }
}

TEST(ColorMap, DivergingIsLightestAndNeutralInTheMiddle) {
  const Rgb middle = color_at(ColorMap::kDiverging, 0.5);
  EXPECT_NEAR(middle[0], middle[2], 0.02);
  for (const double fraction : {0.0, 0.2, 0.4, 0.6, 0.8, 1.0})
    EXPECT_LT(lightness(color_at(ColorMap::kDiverging, fraction)), lightness(middle));
}

TEST(ColorMap, ScaleMapsItsEndsToThoseOfTheMap) {
  const ColorScale scale{ColorMap::kDiverging, -2.0, 4.0};
  EXPECT_EQ(scale.color(-2.0), color_at(ColorMap::kDiverging, 0.0));
  EXPECT_EQ(scale.color(1.0), color_at(ColorMap::kDiverging, 0.5));
  EXPECT_EQ(scale.color(4.0), color_at(ColorMap::kDiverging, 1.0));
}

TEST(ColorMap, RejectsAScaleWithoutExtent) {
  for (const auto& [low, high] : {std::pair{1.0, 1.0}, {2.0, 1.0}, {0.0, kInfinity}, {kNan, 1.0}})
    EXPECT_EQ(check_scale({ColorMap::kSequential, low, high}).error().code,
              ErrorCode::kInvalidArgument);
  EXPECT_TRUE(check_scale({}));
}

}  // namespace
}  // namespace lefort::report::test_color_map
