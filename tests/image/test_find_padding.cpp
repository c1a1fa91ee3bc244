#include <lefort/image/find_padding.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lefort::image::test_find_padding {
namespace {

constexpr double kTissueHu = -300.0;

/// Slices of a round head of 60 mm with a skin blurred over 3 mm, in a circular field of view
/// outside which all voxels are `padding_hu`. Air is not constant, as in a scan.
CtVolume round_scan(double view_mm, std::int16_t padding_hu, double head_mm = 60.0) {
  CtVolume ct{{.size = {141, 141, 5}, .spacing_mm = {1.0, 1.0, 2.0}, .origin_L = {-70, -70, 0}},
              {}};
  for (Index k = 0; k < 5; ++k)
    for (Index j = 0; j < 141; ++j)
      for (Index i = 0; i < 141; ++i) {
        const double r_mm = std::hypot(double(i - 70), double(j - 70));
        const double fraction = std::clamp(0.5 + (head_mm - r_mm) / 3.0, 0.0, 1.0);
        const double hu = -1000.0 + 1040.0 * fraction + double((7 * i + 5 * j + k) % 11);
        ct.values.push_back(r_mm > view_mm ? padding_hu : std::int16_t(std::lround(hu)));
      }
  return ct;
}

TEST(FindPadding, ARoundFieldOfViewAroundTheWholeHeadCutsNothing) {
  for (const std::int16_t hu : {std::int16_t(-2000), std::int16_t(-1024), std::int16_t(-1000)}) {
    const Padding padding = find_padding(round_scan(69.0, hu), kTissueHu);
    EXPECT_EQ(padding.hu, hu);
    EXPECT_NEAR(padding.fraction, 1.0 - std::numbers::pi * 69.0 * 69.0 / (141.0 * 141.0), 0.01);
    EXPECT_EQ(padding.truncated_mm2, 0.0);
  }
}

TEST(FindPadding, AFieldOfViewWithinTheHeadCutsItAllAround) {
  for (const std::int16_t hu : {std::int16_t(-2000), std::int16_t(-1024), std::int16_t(-1000)}) {
    const Padding padding = find_padding(round_scan(50.0, hu), kTissueHu);
    EXPECT_EQ(padding.hu, hu);
    // The projected width of a circle along each axis is its diameter; the height is 10 mm.
    EXPECT_NEAR(padding.truncated_mm2, 4.0 * 101.0 * 10.0, 1.0);
  }
}

TEST(FindPadding, AScanWithoutPaddingHasNone) {
  CtVolume ct = round_scan(200.0, 0);
  EXPECT_LT(find_padding(ct, kTissueHu).fraction, 0.02);  // Only at the faces of the grid.
  EXPECT_EQ(find_padding(ct, kTissueHu).truncated_mm2, 0.0);
  // A head that fills the grid is truncated by the grid, not by padding.
  ct = round_scan(200.0, 0, 150.0);
  EXPECT_EQ(find_padding(ct, kTissueHu).truncated_mm2, 0.0);
  EXPECT_EQ(find_padding({}, kTissueHu).fraction, 0.0);
}

}  // namespace
}  // namespace lefort::image::test_find_padding
