#include <lefort/contact/penalty.h>

#include <gtest/gtest.h>

#include <cmath>

namespace lefort::contact::test_penalty {
namespace {

constexpr double kStiffness = 0.05;
constexpr double kRadius_mm = 8.0;

/// A ball at the origin, with exact gap and derivatives.
PenaltyResponse against_ball(const Vec3& p, const PressureLaw& law = {kStiffness}) {
  const double r = p.norm();
  const Vec3 n = p / r;
  return penalty_response(kRadius_mm - r, n, (Mat3::Identity() - n * n.transpose()) / r, law);
}

TEST(Penalty, EnergyIsStiffnessTimesDepthSquared) {
  EXPECT_DOUBLE_EQ(against_ball({6.0, 0.0, 0.0}).energy_mj_per_mm2, kStiffness * 4.0);
}

TEST(Penalty, TheHardeningTermGrowsWithTheSquareOfTheDepth) {
  const PressureLaw law = hardening_law(0.0, 0.015, 0.05);
  EXPECT_DOUBLE_EQ(pressure_mpa(0.05, law), 0.06);
  EXPECT_DOUBLE_EQ(pressure_mpa(0.1, law), 0.24);
  EXPECT_NEAR(against_ball({7.9, 0.0, 0.0}, law).energy_mj_per_mm2, 0.008, 1e-15);
  // Beyond twice the tolerance the pressure continues with its slope there.
  EXPECT_DOUBLE_EQ(pressure_mpa(0.2, law), 0.24 + 0.1 * 2.0 * 24.0 * 0.1);
  EXPECT_DOUBLE_EQ(pressure_slope_mpa_per_mm(0.2, law), 2.0 * 24.0 * 0.1);
}

TEST(Penalty, PushesTissueOutOfTheBone) {
  const Vec3 traction = -against_ball({6.0, 0.0, 0.0}).gradient_mpa;
  EXPECT_DOUBLE_EQ(traction.x(), 2.0 * kStiffness * 2.0);
  EXPECT_EQ(traction.y(), 0.0);
}

TEST(Penalty, NoForceOutsideOrOnTheSurface) {
  EXPECT_EQ(against_ball({8.0, 0.0, 0.0}).gradient_mpa, Vec3::Zero());
  EXPECT_EQ(against_ball({9.0, 1.0, 0.0}).energy_mj_per_mm2, 0.0);
  EXPECT_EQ(penalty_response(std::nan(""), Vec3::UnitX(), Mat3::Zero(), {1.0}).energy_mj_per_mm2,
            0.0);
}

class PressureLaws : public testing::TestWithParam<PressureLaw> {};
INSTANTIATE_TEST_SUITE_P(Penalty, PressureLaws,
                         testing::Values(PressureLaw{kStiffness, 0.0}, PressureLaw{0.0, 0.03, 2.0},
                                         PressureLaw{kStiffness, 0.03, 2.0},
                                         PressureLaw{kStiffness, 0.03, 0.5}));

TEST_P(PressureLaws, GradientAndHessianAreThoseOfTheEnergy) {
  constexpr double kStep = 1e-5;
  const Vec3 p(3.0, -4.0, 5.0);
  const auto against_ball = [](const Vec3& at) {
    return test_penalty::against_ball(at, GetParam());
  };
  const PenaltyResponse at_p = against_ball(p);
  EXPECT_NEAR(at_p.gradient_mpa.norm(), pressure_mpa(kRadius_mm - p.norm(), GetParam()), 1e-15);
  for (int axis = 0; axis < 3; ++axis) {
    const PenaltyResponse plus = against_ball(p + kStep * Vec3::Unit(axis));
    const PenaltyResponse minus = against_ball(p - kStep * Vec3::Unit(axis));
    EXPECT_NEAR(at_p.gradient_mpa[axis],
                (plus.energy_mj_per_mm2 - minus.energy_mj_per_mm2) / (2.0 * kStep), 1e-9);
    EXPECT_LT((at_p.hessian_mpa_per_mm.col(axis) -
               (plus.gradient_mpa - minus.gradient_mpa) / (2.0 * kStep))
                  .norm(),
              1e-9);
  }
}

/// Hessian of a gap whose gradient is along x.
Mat3 curved(double xx, double yy, double zz) { return Vec3(xx, yy, zz).asDiagonal(); }

TEST_P(PressureLaws, PsdProjectedHessianOmitsTheNegativePartOnConvexBone) {
  const Vec3 n = Vec3::UnitX();
  const Mat3 bulge = curved(0.0, 0.5, 0.25);
  const double slope = pressure_slope_mpa_per_mm(1.0, GetParam());
  EXPECT_LT(penalty_response(1.0, n, bulge, GetParam()).hessian_mpa_per_mm(1, 1), 0.0);
  EXPECT_LT((psd_projected_hessian(1.0, n, bulge, GetParam()) - slope * n * n.transpose()).norm(),
            1e-15);
}

TEST_P(PressureLaws, PsdProjectedHessianIsExactOnConcaveBone) {
  const Vec3 n = Vec3::UnitX();
  const Mat3 hollow = curved(0.0, -0.5, -0.25);
  EXPECT_LT((psd_projected_hessian(1.0, n, hollow, GetParam()) -
             penalty_response(1.0, n, hollow, GetParam()).hessian_mpa_per_mm)
                .norm(),
            1e-15);
  EXPECT_EQ(psd_projected_hessian(-0.1, n, hollow, GetParam()), Mat3::Zero());
}

}  // namespace
}  // namespace lefort::contact::test_penalty
