#include <lefort/field/build/build_distance_field.h>
#include <lefort/field/query/slice_field.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "support/shapes.h"

namespace lefort::field::test_slice_field {
namespace {

/// A ball of 10 mm around (1, 2, 3).
DistanceField ball(bool smooth = false) {
  return build_distance_field(test::make_icosphere(10, 5, Vec3(1, 2, 3)),
                              {.resolution = 128, .smooth = smooth})
      .value();
}

TEST(SliceField, ContainsTheDistancesOfThePlane) {
  const DistanceField field = ball(true);
  for (int axis = 0; axis < 3; ++axis)
    for (const bool smooth : {false, true}) {
      const FieldSlice slice =
          slice_field(field, {.axis = axis, .at_mm = 4.0, .pixel_mm = 0.25, .smooth = smooth})
              .value();
      Index known = 0;
      for (int row = 0; row < slice.rows; ++row)
        for (int column = 0; column < slice.columns; ++column) {
          const Vec3 p = slice.place(column, row);
          ASSERT_EQ(p[axis], 4.0);
          ASSERT_TRUE(field.box_B().contains(p));
          const double d = slice.distances_mm[std::size_t(row * slice.columns + column)];
          if (!std::isfinite(d)) continue;
          ++known;
          ASSERT_NEAR(d, (p - Vec3(1, 2, 3)).norm() - 10.0, 0.02);
          ASSERT_NEAR(slice.pixel_at(p).x(), column, 1e-9);
          ASSERT_NEAR(slice.pixel_at(p).y(), row, 1e-9);
        }
      EXPECT_GT(known, 1000);
    }
}

TEST(SliceField, OrientationIsThatOfRadiology) {
  const DistanceField field = ball();
  const auto sides = [&](int axis) {
    const FieldSlice slice = slice_field(field, {.axis = axis, .at_mm = 3.0}).value();
    return std::pair(slice.right_B, slice.down_B);
  };
  const Vec3 left(1, 0, 0), posterior(0, 1, 0), inferior(0, 0, -1);
  EXPECT_EQ(sides(0), (std::pair(posterior, inferior)));  // From the left: front is left.
  EXPECT_EQ(sides(1), (std::pair(left, inferior)));       // From the front: right is left.
  EXPECT_EQ(sides(2), (std::pair(left, posterior)));      // From the feet: right is left.
}

TEST(SliceField, ShowsOnlyARegion) {
  const Box3 region(Vec3(-2, -100, 0), Vec3(3, 100, 8));
  const FieldSlice slice =
      slice_field(ball(), {.axis = 1, .at_mm = 2.0, .region_B = region, .pixel_mm = 0.5}).value();
  EXPECT_EQ(slice.columns, 10);
  EXPECT_EQ(slice.rows, 16);
  EXPECT_LT((slice.place(-0.5, -0.5) - Vec3(-2, 2, 8)).norm(), 1e-12);  // Upper left corner.
  EXPECT_LT((slice.place(9.5, 15.5) - Vec3(3, 2, 0)).norm(), 1e-12);
}

TEST(SliceField, SummaryMatchesACircle) {
  const DistanceField field = ball();
  const SliceSummary summary =
      summarize(slice_field(field, {.axis = 2, .at_mm = 9.0, .pixel_mm = 0.05}).value());
  EXPECT_NEAR(summary.inside_mm2, std::numbers::pi * 64.0, 0.5);
  EXPECT_NEAR(summary.zero_line_mm, 2 * std::numbers::pi * 8.0, 0.1);
  EXPECT_GT(summary.pixels.inside, 0);
  EXPECT_GT(summary.pixels.outside, 0);
  EXPECT_EQ(summary.pixels.unknown, 0);
  EXPECT_GE(summary.min_mm, -field.band_mm());
  EXPECT_LT(summary.min_mm, -field.guaranteed_mm() + 0.1);
  EXPECT_GT(summary.max_mm, field.guaranteed_mm() - 0.1);
  EXPECT_EQ(summarize({.corner_B = Vec3::Zero(),
                       .right_B = Vec3::UnitX(),
                       .down_B = Vec3::UnitY(),
                       .pixel_mm = 1.0,
                       .columns = 1,
                       .rows = 1,
                       .distances_mm = {std::numeric_limits<double>::quiet_NaN()}})
                .pixels.unknown,
            1);
}

TEST(SliceField, RejectsEmptySlices) {
  const DistanceField field = ball();
  const auto complaint = [&](const SliceOptions& options) {
    const auto slice = slice_field(field, options);
    if (slice) return std::string("accepted");
    EXPECT_EQ(slice.error().code, ErrorCode::kInvalidArgument);
    return slice.error().message;
  };
  const auto names = [](const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
  };
  EXPECT_TRUE(names(complaint({.axis = 3}), "axis is 3"));
  EXPECT_TRUE(names(complaint({.axis = 0, .at_mm = 50}), "x = 50"));
  EXPECT_TRUE(names(complaint({.axis = 0, .at_mm = std::nan("")}), "nan"));
  EXPECT_TRUE(names(complaint({.axis = 2, .at_mm = 3, .pixel_mm = 0.0}), "pixels"));
  EXPECT_TRUE(names(complaint({.axis = 2, .at_mm = 3, .pixel_mm = 1e-9}), "pixels"));
  EXPECT_TRUE(names(complaint({.axis = 2, .at_mm = 3, .smooth = true}), "smooth"));
  EXPECT_TRUE(
      names(complaint({.axis = 2, .at_mm = 3, .region_B = Box3(Vec3(50, 50, 0), Vec3(60, 60, 9))}),
            "region"));
}

}  // namespace
}  // namespace lefort::field::test_slice_field
