/// \file
/// The error of the measured skin of synthetic cases.
#include <lefort/pipeline/validate/phantom_case.h>

#include <gtest/gtest.h>

#include <cmath>

namespace lefort::pipeline {
namespace {

TEST(RandomField, HasUnitVarianceAtAndBetweenLatticePoints) {
  for (const double offset_mm : {0.0, 2.5, 5.0}) {
    double sum = 0.0, squares = 0.0;
    constexpr int kCount = 20;
    for (int i = 0; i < kCount; ++i)
      for (int j = 0; j < kCount; ++j)
        for (int k = 0; k < kCount; ++k) {
          const Vec3 cell(3.0 * i - 30.0, 3.0 * j - 30.0, 3.0 * k - 30.0);
          const double one =
              random_field(kSkinNoiseLength_mm * cell + Vec3::Constant(offset_mm), 7);
          sum += one;
          squares += one * one;
        }
    constexpr double kTotal = double(kCount) * kCount * kCount;
    // Five standard errors: 1 / sqrt(n) of the mean, sqrt(2 / n) of the variance.
    EXPECT_NEAR(sum / kTotal, 0.0, 5.0 / std::sqrt(kTotal));
    EXPECT_NEAR(squares / kTotal, 1.0, 5.0 * std::sqrt(2.0 / kTotal));
  }
}

TEST(RandomField, IsContinuousAndIndependentFarAway) {
  double covariance = 0.0;
  constexpr int kCount = 4000;
  for (int i = 0; i < kCount; ++i) {
    const Vec3 at_mm(7.3 * i, -11.1 * i, 3.7 * i);
    EXPECT_NEAR(random_field(at_mm, 3), random_field(at_mm + Vec3(1e-6, 0, 0), 3), 1e-5);
    covariance += random_field(at_mm, 3) * random_field(at_mm + Vec3(0, 0, 25), 3) / kCount;
  }
  EXPECT_NEAR(covariance, 0.0, 5.0 / std::sqrt(double(kCount)));
}

TEST(RandomField, DependsOnItsSeed) {
  EXPECT_NE(random_field(Vec3(1, 2, 3), 1), random_field(Vec3(1, 2, 3), 2));
  EXPECT_EQ(random_field(Vec3(1, 2, 3), 1), random_field(Vec3(1, 2, 3), 1));
}

}  // namespace
}  // namespace lefort::pipeline
