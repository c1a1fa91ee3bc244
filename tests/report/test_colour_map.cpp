#include <lefort/report/colour_map.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace lefort::report {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// CIE lightness L*, 0 to 100.
double lightness(const Rgb& colour) {
  const auto decode = [](double c) {
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
  };
  const double y =
      0.2126 * decode(colour[0]) + 0.7152 * decode(colour[1]) + 0.0722 * decode(colour[2]);
  return y > 0.008856 ? 116.0 * std::cbrt(y) - 16.0 : 903.3 * y;
}

TEST(ColourMap, EndsAreThoseOfThePublishedTables) {
  EXPECT_EQ(colour_at(ColourMap::kSequential, 0.0), (Rgb{252 / 255.0, 253 / 255.0, 191 / 255.0}));
  EXPECT_EQ(colour_at(ColourMap::kDiverging, 0.0), (Rgb{59 / 255.0, 76 / 255.0, 192 / 255.0}));
  EXPECT_EQ(colour_at(ColourMap::kDiverging, 1.0), (Rgb{180 / 255.0, 4 / 255.0, 38 / 255.0}));
}

TEST(ColourMap, BeyondTheEndsItKeepsTheirColours) {
  for (const ColourMap map : {ColourMap::kSequential, ColourMap::kDiverging}) {
    EXPECT_EQ(colour_at(map, -kInfinity), colour_at(map, 0.0));
    EXPECT_EQ(colour_at(map, 7.0), colour_at(map, 1.0));
  }
}

TEST(ColourMap, NotANumberIsGrey) {
  EXPECT_EQ(colour_at(ColourMap::kSequential, kNan), kMissingColour);
  EXPECT_EQ((ColourScale{ColourMap::kDiverging, -1.0, 1.0}.colour(kNan)), kMissingColour);
}

TEST(ColourMap, SequentialDarkensInEvenSteps) {
  const double whole = lightness(colour_at(ColourMap::kSequential, 0.0)) -
                       lightness(colour_at(ColourMap::kSequential, 1.0));
  EXPECT_GT(whole, 50.0);
  for (int i = 0; i < 20; ++i) {
    const double step = lightness(colour_at(ColourMap::kSequential, i / 20.0)) -
                        lightness(colour_at(ColourMap::kSequential, (i + 1) / 20.0));
    EXPECT_NEAR(step, whole / 20.0, 0.35 * whole / 20.0) << "from share " << i / 20.0;
  }
}

TEST(ColourMap, DivergingIsLightestAndNeutralInTheMiddle) {
  const Rgb middle = colour_at(ColourMap::kDiverging, 0.5);
  EXPECT_NEAR(middle[0], middle[2], 0.02);
  for (const double share : {0.0, 0.2, 0.4, 0.6, 0.8, 1.0})
    EXPECT_LT(lightness(colour_at(ColourMap::kDiverging, share)), lightness(middle));
}

TEST(ColourMap, ScaleMapsItsEndsToThoseOfTheMap) {
  const ColourScale scale{ColourMap::kDiverging, -2.0, 4.0};
  EXPECT_EQ(scale.colour(-2.0), colour_at(ColourMap::kDiverging, 0.0));
  EXPECT_EQ(scale.colour(1.0), colour_at(ColourMap::kDiverging, 0.5));
  EXPECT_EQ(scale.colour(4.0), colour_at(ColourMap::kDiverging, 1.0));
}

TEST(ColourMap, RefusesAScaleWithoutExtent) {
  for (const auto& [low, high] : {std::pair{1.0, 1.0}, {2.0, 1.0}, {0.0, kInfinity}, {kNan, 1.0}})
    EXPECT_EQ(check_scale({ColourMap::kSequential, low, high}).error().code,
              ErrorCode::kInvalidArgument);
  EXPECT_TRUE(check_scale({}));
}

}  // namespace
}  // namespace lefort::report
