#include <lefort/fem/materials/volumetric.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace lefort::fem::test_volumetric {
namespace {

constexpr VolumetricForm kForms[] = {VolumetricForm::kQuadratic, VolumetricForm::kQuadraticLog,
                                     VolumetricForm::kLogSquared};

TEST(Volumetric, MatchesItsFormulas) {
  for (const double J : {0.2, 0.7, 1.0, 1.6, 3.0}) {
    EXPECT_NEAR((Volumetric{VolumetricForm::kQuadratic, 4.0}.energy(J)), 2.0 * (J - 1) * (J - 1),
                1e-14);
    EXPECT_NEAR((Volumetric{VolumetricForm::kQuadraticLog, 4.0}.energy(J)),
                J * J - 1 - 2 * std::log(J), 1e-14);
    EXPECT_NEAR((Volumetric{VolumetricForm::kLogSquared, 4.0}.energy(J)),
                2.0 * std::log(J) * std::log(J), 1e-14);
  }
}

TEST(Volumetric, FirstAndSecondDerivativeAreThoseOfTheEnergy) {
  constexpr double kStep = 1e-5;
  for (const VolumetricForm form : kForms) {
    const Volumetric volume{form, 4.0};
    for (double J = 0.2; J < 4.0; J += 0.01) {
      const double slope = (volume.energy(J + kStep) - volume.energy(J - kStep)) / 2 / kStep;
      const double curvature = (volume.dU_dJ(J + kStep) - volume.dU_dJ(J - kStep)) / 2 / kStep;
      EXPECT_NEAR(volume.dU_dJ(J), slope, 1e-6 * (1.0 + std::abs(slope)));
      EXPECT_NEAR(volume.d2U_dJ2(J), curvature, 1e-6 * (1.0 + std::abs(curvature)));
    }
    EXPECT_EQ(volume.energy(1.0), 0.0);
    EXPECT_EQ(volume.dU_dJ(1.0), 0.0);
    EXPECT_EQ(volume.d2U_dJ2(1.0), 4.0);
  }
}

TEST(Volumetric, EveryFormIsHalfKappaTimesTheSquareOfASmallChange) {
  for (const VolumetricForm form : kForms) {
    const Volumetric volume{form, 4.0};
    // The third derivative at J = 1, divided by kappa.
    const double third = form == VolumetricForm::kQuadratic      ? 0.0
                         : form == VolumetricForm::kQuadraticLog ? -1.0
                                                                 : -3.0;
    for (const double change : {1e-4, -1e-5, 1e-8, -1e-12, 1e-100}) {
      const double expected = 2.0 * change * change * (1.0 + third / 3.0 * change);
      EXPECT_NEAR(volume.energy_minus_one(change), expected,
                  expected * (2.0 * change * change + 1e-15));
    }
  }
}

TEST(Volumetric, TheSeriesOfASmallChangeMatchesTheLogarithm) {
  const Volumetric volume{VolumetricForm::kQuadraticLog, 4.0};
  for (const double change : {-0.1, 0.1}) {  // Where the series is replaced by the logarithm.
    const double within = volume.energy_minus_one(change * (1.0 - 1e-15));
    EXPECT_NEAR(within, volume.energy_minus_one(change), 2e-14 * within);
  }
}

TEST(Volumetric, RejectsABulkModulusThatIsNotPositive) {
  for (const double bad : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::infinity()}) {
    const auto result = Volumetric{VolumetricForm::kQuadratic, bad}.validate();
    ASSERT_FALSE(result.has_value());
    EXPECT_EQ(result.error().code, ErrorCode::kInvalidArgument);
    EXPECT_NE(result.error().message.find("kappa is"), std::string::npos);
  }
  EXPECT_TRUE((Volumetric{VolumetricForm::kQuadratic, 1.0}.validate().has_value()));
}

}  // namespace
}  // namespace lefort::fem::test_volumetric
