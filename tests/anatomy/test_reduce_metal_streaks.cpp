/// \file
/// Metal streaks are removed; what the patient has remains.
#include <lefort/anatomy/reduce_metal_streaks.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lefort::anatomy::test_reduce_metal_streaks {
namespace {

constexpr Index kFirst = 9, kLast = 11;  ///< Slices with streaks.

/// Two teeth that cross all slices of a round neck.
const Vec3 kTeeth[2] = {{-15.0, -20.0, 0.0}, {15.0, -20.0, 0.0}};

double to_tooth(const Vec3& p) {
  return std::min((p - kTeeth[0]).head<2>().norm(), (p - kTeeth[1]).head<2>().norm());
}

/// Without metal if `fillings` is false.
image::CtVolume scan(bool fillings, std::size_t across = 2) {
  image::CtVolume ct{{{120, 120, 20}, {0.8, 0.8, 1.0}, {-48, -48, 0}, Mat3::Identity()}, {}};
  if (across == 1) {  // The same scan with its slices across j.
    ct.grid.size = {120, 20, 120};
    ct.grid.spacing_mm = {0.8, 1.0, 0.8};
    ct.grid.direction << 1, 0, 0, 0, 0, -1, 0, 1, 0;
    ct.grid.origin_L = {-48, 48, 0};
  }
  for (Index k = 0; k < ct.grid.size[2]; ++k)
    for (Index j = 0; j < ct.grid.size[1]; ++j)
      for (Index i = 0; i < ct.grid.size[0]; ++i) {
        const Index slice = across == 2 ? k : j;
        const Vec3 p(-48 + 0.8 * double(i), -48 + 0.8 * double(across == 2 ? j : k), 0.0);
        double value = p.norm() < 40.0 ? 40.0 : -1000.0;
        if (to_tooth(p) < 4.0) value = 1800.0;
        if (fillings && slice >= kFirst && slice <= kLast) {
          for (const Vec3& tooth : kTeeth) {
            const Vec3 from = p - tooth;
            const double angle = std::atan2(from.y(), from.x());
            value += 1500.0 * std::cos(16.0 * angle) * std::exp(-from.head<2>().norm() / 30.0);
          }
          if (to_tooth(p) < 3.0) value = (i + j) % 2 == 0 ? 3071.0 : -1024.0;  // Wrapped.
        }
        ct.values.push_back(std::int16_t(std::clamp(value, -1024.0, 3071.0)));
      }
  return ct;
}

TEST(ReduceMetalStreaks, AScanWithoutMetalStays) {
  const image::CtVolume ct = scan(false);
  const StreakReduction reduced = reduce_metal_streaks(ct, 226.0, -300.0);
  EXPECT_EQ(reduced.slices, 0);
  EXPECT_EQ(reduced.ct.values, ct.values);
}

TEST(ReduceMetalStreaks, NothingIsBoneOrAirFurtherFromTheTeethThanThreeMillimeters) {
  const image::CtVolume ct = scan(true), clean = scan(false);
  const StreakReduction reduced = reduce_metal_streaks(ct, 226.0, -300.0);
  EXPECT_EQ(reduced.slices, kLast - kFirst + 1);
  Index bone_before = 0, teeth = 0;
  for (Index k = 0; k < 20; ++k)
    for (Index j = 0; j < 120; ++j)
      for (Index i = 0; i < 120; ++i) {
        const Vec3 p(-48 + 0.8 * double(i), -48 + 0.8 * double(j), 0.0);
        const int value = reduced.ct.at(i, j, k);
        if (k < kFirst || k > kLast) {
          ASSERT_EQ(value, ct.at(i, j, k));
        } else if (to_tooth(p) > 7.5) {
          if (ct.at(i, j, k) >= 226) ++bone_before;
          ASSERT_LT(value, 226) << i << " " << j;
          ASSERT_TRUE(p.norm() > 36.0 || value > -300) << i << " " << j;
          ASSERT_TRUE(p.norm() < 49.0 || value < -300) << i << " " << j;
        } else if (to_tooth(p) < 3.5 && value >= 1500) {
          ++teeth;
        }
      }
  EXPECT_GT(bone_before, 500);  // There were streaks.
  Index true_teeth = 0;
  for (Index k = kFirst; k <= kLast; ++k)
    for (Index j = 0; j < 120; ++j)
      for (Index i = 0; i < 120; ++i)
        if (clean.at(i, j, k) == 1800) {
          const Vec3 p(-48 + 0.8 * double(i), -48 + 0.8 * double(j), 0.0);
          if (to_tooth(p) < 3.5) ++true_teeth;
        }
  EXPECT_GT(double(teeth), 0.95 * double(true_teeth));
}

TEST(ReduceMetalStreaks, FindsTheSlicesAcrossAnyAxis) {
  const image::CtVolume ct = scan(true, 1);
  const StreakReduction reduced = reduce_metal_streaks(ct, 226.0, -300.0);
  EXPECT_EQ(reduced.slices, kLast - kFirst + 1);
}

TEST(ReduceMetalStreaks, MetalAtTheEndOfTheScanIsLeft) {
  image::CtVolume ct = scan(true);
  const Index removed = kFirst * 120 * 120;
  ct.values.erase(ct.values.begin(), ct.values.begin() + removed);
  ct.grid.size[2] -= kFirst;
  const StreakReduction reduced = reduce_metal_streaks(ct, 226.0, -300.0);
  EXPECT_EQ(reduced.slices, 0);
  EXPECT_EQ(reduced.ct.values, ct.values);
}

}  // namespace
}  // namespace lefort::anatomy::test_reduce_metal_streaks
