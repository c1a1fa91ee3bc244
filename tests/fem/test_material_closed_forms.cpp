// Every law compared with closed forms of uniaxial and equibiaxial stretch and simple shear.
#include <lefort/fem/materials/material.h>

#include <gtest/gtest.h>

#include <cmath>

#include "fem/material_examples.h"

namespace lefort::fem::test_material_closed_forms {
namespace {

using test::Example;

constexpr double kPrecision = 1e-13;
constexpr double kStretches[] = {0.5, 0.8, 0.99, 1.0, 1.001, 1.3, 2.0, 3.0};
constexpr double kShears[] = {-1.5, -0.2, 0.0, 1e-4, 0.4, 1.0, 2.0};

Mat3 uniaxial(double s) { return Vec3(s, 1.0 / std::sqrt(s), 1.0 / std::sqrt(s)).asDiagonal(); }

Mat3 equibiaxial(double s) { return Vec3(s, s, 1.0 / (s * s)).asDiagonal(); }

Mat3 simple_shear(double gamma) {
  Mat3 F = Mat3::Identity();
  F(0, 1) = gamma;
  return F;
}

/// Stress of an incompressible body whose faces z = const are free, which determines the pressure.
template <class Law>
Mat3 true_stress_free_in_z(const Law& law, const Mat3& F) {
  const Mat3 sigma = cauchy_stress(law.stress(F), F);
  return sigma - sigma(2, 2) * Mat3::Identity();
}

Mat3 in_plane(double xx, double yy, double xy) {
  Mat3 sigma = Mat3::Zero();
  sigma(0, 0) = xx;
  sigma(1, 1) = yy;
  sigma(0, 1) = sigma(1, 0) = xy;
  return sigma;
}

void expect_near(const Mat3& found, const Mat3& expected, double at) {
  EXPECT_LT((found - expected).norm(), kPrecision * (1.0 + expected.norm())) << "at " << at;
}

/// dPsi/dI1 and dPsi/dI2.
struct Slopes {
  double W1;
  double W2;
};

Slopes slopes(const IsochoricNeoHookean& law, double /*I1*/) { return {0.5 * law.mu_mpa, 0.0}; }
Slopes slopes(const MooneyRivlin& law, double /*I1*/) { return {law.c10_mpa, law.c01_mpa}; }
Slopes slopes(const Yeoh& law, double I1) {
  const double x = I1 - 3.0;
  return {law.c10_mpa + 2.0 * law.c20_mpa * x + 3.0 * law.c30_mpa * x * x, 0.0};
}

/// Cauchy stress of a law in I1 and I2.
template <class Law>
struct ClosedForm {
  static double uniaxial(const Law& law, double s) {
    const auto [W1, W2] = slopes(law, s * s + 2.0 / s);
    return 2.0 * (s * s - 1.0 / s) * (W1 + W2 / s);
  }
  static double equibiaxial(const Law& law, double s) {
    const auto [W1, W2] = slopes(law, 2.0 * s * s + std::pow(s, -4));
    return 2.0 * (s * s - std::pow(s, -4)) * (W1 + W2 * s * s);
  }
  static Mat3 simple_shear(const Law& law, double gamma) {
    const auto [W1, W2] = slopes(law, 3.0 + gamma * gamma);
    return 2.0 * in_plane(W1 * gamma * gamma, -W2 * gamma * gamma, (W1 + W2) * gamma);
  }
};

template <>
struct ClosedForm<Ogden> {
  static double sum(const Ogden& law, double s, double t) {
    double difference = 0.0;
    for (const OgdenTerm& term : law.terms)
      difference += term.mu_mpa * (std::pow(s, term.alpha) - std::pow(t, term.alpha));
    return difference;
  }
  static double uniaxial(const Ogden& law, double s) { return sum(law, s, 1.0 / std::sqrt(s)); }
  static double equibiaxial(const Ogden& law, double s) { return sum(law, s, 1.0 / (s * s)); }
  static Mat3 simple_shear(const Ogden& law, double gamma) {
    // Principal stretches s, 1/s and 1, where gamma = s - 1/s; the first along (s, 1, 0).
    const double s = 0.5 * (gamma + std::sqrt(gamma * gamma + 4.0));
    const double first = sum(law, s, 1.0);
    const double second = sum(law, 1.0 / s, 1.0);
    return in_plane(first * s * s + second, first + second * s * s, (first - second) * s) /
           (1.0 + s * s);
  }
};

template <class Law>
class ClosedForms : public testing::Test {};
using Isotropic = testing::Types<IsochoricNeoHookean, MooneyRivlin, Yeoh, Ogden>;
TYPED_TEST_SUITE(ClosedForms, Isotropic);

TYPED_TEST(ClosedForms, OfUniaxialAndEquibiaxialStretchAreMatched) {
  const auto law = Example<TypeParam>::law();
  for (const double s : kStretches) {
    expect_near(true_stress_free_in_z(law, uniaxial(s)),
                in_plane(ClosedForm<TypeParam>::uniaxial(law, s), 0.0, 0.0), s);
    const double biaxial = ClosedForm<TypeParam>::equibiaxial(law, s);
    expect_near(true_stress_free_in_z(law, equibiaxial(s)), in_plane(biaxial, biaxial, 0.0), s);
  }
}

TYPED_TEST(ClosedForms, OfSimpleShearAreMatched) {
  const auto law = Example<TypeParam>::law();
  for (const double gamma : kShears)
    expect_near(true_stress_free_in_z(law, simple_shear(gamma)),
                ClosedForm<TypeParam>::simple_shear(law, gamma), gamma);
}

/// \returns the lateral stretch t at which diag(s, t, t) is free on its sides.
template <class Law>
double free_stretch_across(const Law& law, double s) {
  double t = 1.0 / std::sqrt(s);
  for (int n = 0; n < 50; ++n) {
    const Mat3 F = Vec3(s, t, t).asDiagonal();
    const Mat9 A = law.tangent(F);
    t -= law.stress(F)(1, 1) / (A(4, 4) + A(4, 8));
  }
  return t;
}

TYPED_TEST(ClosedForms, AreTheLimitOfADecoupledLawForALargeBulkModulus) {
  DecoupledLaw<TypeParam> law{.isochoric = Example<TypeParam>::law()};
  for (const VolumetricForm form :
       {VolumetricForm::kQuadratic, VolumetricForm::kQuadraticLog, VolumetricForm::kLogSquared}) {
    for (const double kappa_mpa : {1e3, 1e5}) {
      law.volume = {form, kappa_mpa};
      for (const double s : {0.6, 1.2, 2.0}) {
        const double t = free_stretch_across(law, s);
        const Mat3 F = Vec3(s, t, t).asDiagonal();
        const double sigma = cauchy_stress(law.stress(F), F)(0, 0);
        const double limit = ClosedForm<TypeParam>::uniaxial(law.isochoric, s);
        EXPECT_NEAR(sigma, limit, 20.0 * limit * limit / kappa_mpa) << "at " << s;
        // The pressure sigma/3 is kappa times the change of volume.
        EXPECT_NEAR(volume_ratio(F) - 1.0, limit / 3.0 / kappa_mpa,
                    20.0 * std::pow(limit / kappa_mpa, 2) + 1e-12)
            << "at " << s;
      }
    }
  }
}

TEST(NeoHookean, SimpleShearMatchesTheTextbook) {
  const NeoHookean law{.mu_mpa = 0.5, .lambda_mpa = 10.0};
  const double gamma = 0.8;
  const Mat3 F = simple_shear(gamma);
  const Mat3 sigma = cauchy_stress(law.stress(F), F);
  // mu (F F^T - I): J = 1, no pressure.
  EXPECT_LT((sigma - in_plane(0.5 * gamma * gamma, 0.0, 0.5 * gamma)).norm(), 1e-15);
  EXPECT_NEAR(law.energy(F), 0.25 * gamma * gamma, 1e-15);
}

TEST(NeoHookean, UniformExpansionMatchesTheClosedForm) {
  const NeoHookean law{.mu_mpa = 0.5, .lambda_mpa = 10.0};
  const double s = 1.3;
  const Mat3 sigma = cauchy_stress(law.stress(s * Mat3::Identity()), s * Mat3::Identity());
  const double pressure = (0.5 * (s * s - 1.0) + 10.0 * 3.0 * std::log(s)) / (s * s * s);
  EXPECT_LT((sigma - pressure * Mat3::Identity()).norm(), 1e-13);
}

TEST(NeoHookean, FreeSidesDetermineTheLateralStretch) {
  const NeoHookean law{.mu_mpa = 0.5, .lambda_mpa = 2.0};
  for (const double s : kStretches) {
    const double t = free_stretch_across(law, s);
    // Laterally mu (t^2 - 1) + lambda ln J = 0; the axial Cauchy stress is mu (s^2 - t^2) / J.
    EXPECT_NEAR(0.5 * (t * t - 1.0) + 2.0 * std::log(s * t * t), 0.0, kPrecision);
    const Mat3 F = Vec3(s, t, t).asDiagonal();
    expect_near(cauchy_stress(law.stress(F), F),
                in_plane(0.5 * (s * s - t * t) / (s * t * t), 0.0, 0.0), s);
  }
}

TEST(StVenantKirchhoff, StretchingAndShearMatchTheClosedForms) {
  constexpr double kYoung = 2.0;
  constexpr double kPoisson = 0.3;
  const auto law = StVenantKirchhoff::from_young_poisson(kYoung, kPoisson).value();
  for (const double s : {0.7, 0.99, 1.0, 1.3, 1.4}) {
    const double E = 0.5 * (s * s - 1.0);
    // Hooke's law for E and S = F^-1 P: uniaxial S = young E, lateral strain -poisson E.
    const double across = std::sqrt(1.0 - 2.0 * kPoisson * E);
    expect_near(law.stress(Vec3(s, across, across).asDiagonal()),
                in_plane(s * kYoung * E, 0.0, 0.0), s);
    // Equibiaxial S = young / (1 - poisson) E, lateral strain -2 poisson / (1 - poisson) E.
    const double both = kYoung / (1.0 - kPoisson) * E;
    const double thinned = std::sqrt(1.0 - 4.0 * kPoisson / (1.0 - kPoisson) * E);
    expect_near(law.stress(Vec3(s, s, thinned).asDiagonal()), in_plane(s * both, s * both, 0.0), s);
  }
  for (const double gamma : kShears) {
    const Mat3 F = simple_shear(gamma);
    Mat3 S = 0.5 * law.lambda_mpa * gamma * gamma * Mat3::Identity();
    S(1, 1) += law.mu_mpa * gamma * gamma;
    S(0, 1) = S(1, 0) = law.mu_mpa * gamma;
    expect_near(law.stress(F), F * S, gamma);
  }
}

TEST(LinearElastic, StretchingAndShearMatchHookesLaw) {
  constexpr double kYoung = 2.0;
  constexpr double kPoisson = 0.3;
  const auto law = LinearElastic::from_young_poisson(kYoung, kPoisson).value();
  for (const double e : {-0.1, 0.0, 1e-3, 0.2}) {
    const Vec3 stretches(1.0 + e, 1.0 - kPoisson * e, 1.0 - kPoisson * e);
    expect_near(law.stress(stretches.asDiagonal()), in_plane(kYoung * e, 0.0, 0.0), e);
    const double both = kYoung / (1.0 - kPoisson) * e;
    const Vec3 biaxial(1.0 + e, 1.0 + e, 1.0 - 2.0 * kPoisson / (1.0 - kPoisson) * e);
    expect_near(law.stress(biaxial.asDiagonal()), in_plane(both, both, 0.0), e);
    expect_near(law.stress(simple_shear(e)), in_plane(0.0, 0.0, law.mu_mpa * e), e);
  }
}

TEST(Ogden, OfPowersTwoAndMinusTwoIsMooneyRivlin) {
  const Ogden ogden{.terms = {{{0.8, 2.0}, {-0.3, -2.0}}}};
  const MooneyRivlin mooney{.c10_mpa = 0.4, .c01_mpa = 0.15};
  ASSERT_TRUE(ogden.validate().has_value());
  EXPECT_DOUBLE_EQ(ogden.shear_modulus_mpa(), mooney.shear_modulus_mpa());
  test::RandomDeformation random(31);
  for (int n = 0; n < 4000; ++n) {
    const Mat3 F = random.kind(n);
    const Mat9 A = mooney.tangent(F);
    ASSERT_NEAR(ogden.energy(F), mooney.energy(F), kPrecision * A.norm()) << "sample " << n;
    ASSERT_LT((ogden.stress(F) - mooney.stress(F)).norm(), kPrecision * A.norm()) << "sample " << n;
    ASSERT_LT((ogden.tangent(F) - A).norm(), kPrecision * A.norm()) << "sample " << n;
  }
}

TEST(Yeoh, OfFirstOrderIsNeoHookean) {
  const Yeoh yeoh{.c10_mpa = 0.35};
  const IsochoricNeoHookean neo{.mu_mpa = 0.7};
  test::RandomDeformation random(32);
  for (int n = 0; n < 100; ++n) {
    const Mat3 F = random.kind(n);
    EXPECT_NEAR(yeoh.energy(F), neo.energy(F), 1e-15);
    EXPECT_LT((yeoh.tangent(F) - neo.tangent(F)).norm(), 1e-14);
  }
}

/// F in coordinates along the material axes.
Mat3 along(const FungOrthotropic& law, const Mat3& F) {
  return law.axes * F * law.axes.transpose();
}

Mat3 back(const FungOrthotropic& law, const Mat3& M) { return law.axes.transpose() * M * law.axes; }

TEST(FungOrthotropic, StretchingAlongTheAxesMatchesTheClosedForm) {
  const auto law = Example<FungOrthotropic>::law();
  for (const double s : {0.6, 0.9, 1.0, 1.2, 1.6}) {
    for (const double t : {0.8, 1.0, 1.3}) {
      const Vec3 stretch(s, t, 1.0 / (s * t));
      const Vec3 E = 0.5 * (stretch.cwiseAbs2() - Vec3::Ones());
      const Vec3 T = law.lambda_mpa * E + 2.0 * law.mu_mpa.cwiseProduct(E);
      const Vec3 sigma = std::exp(E.dot(T) / law.c_mpa) * stretch.cwiseAbs2().cwiseProduct(T);
      EXPECT_NEAR(law.energy(along(law, stretch.asDiagonal())),
                  0.5 * law.c_mpa * std::expm1(E.dot(T) / law.c_mpa), 1e-13 * (1.0 + sigma.norm()));
      const Mat3 F = along(law, stretch.asDiagonal());
      expect_near(back(law, cauchy_stress(law.stress(F), F)),
                  (sigma.array() - sigma.mean()).matrix().asDiagonal(), s);
    }
  }
}

TEST(FungOrthotropic, ShearInThePlaneOfTwoAxesMatchesTheClosedForm) {
  const auto law = Example<FungOrthotropic>::law();
  for (const double gamma : {-1.0, -0.1, 0.0, 0.3, 1.2}) {
    const Mat3 F = simple_shear(gamma);  // E_12 = gamma/2, E_22 = gamma^2/2.
    const double E22 = 0.5 * gamma * gamma;
    Mat3 T = (law.lambda_mpa.col(1) * E22).asDiagonal();
    T(1, 1) += 2.0 * law.mu_mpa[1] * E22;
    T(0, 1) = T(1, 0) = 0.5 * (law.mu_mpa[0] + law.mu_mpa[1]) * gamma;
    const double Q = (T(0, 1) * gamma + T(1, 1) * E22) / law.c_mpa;
    const Mat3 sigma = std::exp(Q) * F * T * F.transpose();
    const Mat3 placed = along(law, F);
    expect_near(back(law, cauchy_stress(law.stress(placed), placed)),
                sigma - sigma.trace() / 3.0 * Mat3::Identity(), gamma);
  }
}

TEST(FungOrthotropic, WithEqualConstantsIsIsotropicAndStiffensFromHookesLaw) {
  FungOrthotropic law{.mu_mpa = {0.7, 0.7, 0.7}, .c_mpa = 2.0};
  law.lambda_mpa.setConstant(0.4);
  ASSERT_TRUE(law.validate().has_value());
  test::RandomDeformation random(33);
  for (int n = 0; n < 1000; ++n) {
    const Mat3 F = random.kind(n);
    const double tolerance = kPrecision * law.tangent(F).norm();
    ASSERT_NEAR(law.energy(F * random.rotation()), law.energy(F), tolerance) << "sample " << n;
  }
  // The tangent at rest is that of the neo-Hookean law.
  const Mat9 hooke = IsochoricNeoHookean{.mu_mpa = 0.7}.tangent(Mat3::Identity());
  EXPECT_LT((law.tangent(Mat3::Identity()) - hooke).norm(), 1e-15);
  // The smaller c, the stiffer the stretched tissue.
  const double soft = law.energy(uniaxial(1.4));
  law.c_mpa = 0.5;
  EXPECT_GT(law.energy(uniaxial(1.4)), 1.1 * soft);
}

/// The Cauchy stress of one taut family without pressure: 2 k1 e exp(k2 e^2) (d B + (1 - 3 d) a
/// a^T), where a = F a0.
Mat3 fiber_stress(const HolzapfelGasserOgden& law, const Mat3& F, const Vec3& a0) {
  const Mat3 B = F * F.transpose();
  const Vec3 a = F * a0;
  const double d = law.dispersion;
  const double e = d * (B.trace() - 3.0) + (1.0 - 3.0 * d) * (a.squaredNorm() - 1.0);
  return 2.0 * law.k1_mpa * e * std::exp(law.k2 * e * e) *
         (d * B + (1.0 - 3.0 * d) * a * a.transpose());
}

TEST(HolzapfelGasserOgden, ParallelFibersAreLoadedAlongThemAndNotAcross) {
  const HolzapfelGasserOgden law{.mu_mpa = 0.7, .k1_mpa = 0.9, .k2 = 0.4};
  ASSERT_TRUE(law.validate().has_value());
  for (const double s : {1.001, 1.1, 1.5}) {
    const double matrix = 0.7 * (s * s - 1.0 / s);
    const double e = s * s - 1.0;
    const double fibers = 2.0 * 0.9 * s * s * e * std::exp(0.4 * e * e);
    expect_near(true_stress_free_in_z(law, uniaxial(s)), in_plane(matrix + fibers, 0.0, 0.0), s);
    // Shortened fibers are slack: along y under tension along x, along x under compression there.
    HolzapfelGasserOgden across = law;
    across.fiber[0] = Vec3::UnitY();
    expect_near(true_stress_free_in_z(across, uniaxial(s)), in_plane(matrix, 0.0, 0.0), s);
    expect_near(true_stress_free_in_z(law, uniaxial(1.0 / s)),
                in_plane(0.7 * (1.0 / (s * s) - s), 0.0, 0.0), s);
  }
}

TEST(HolzapfelGasserOgden, ShearAcrossFibersStretchesThemAndAlongThemDoesNot) {
  HolzapfelGasserOgden law{.mu_mpa = 0.7, .k1_mpa = 0.9, .k2 = 0.4};
  for (const double gamma : {-0.8, 0.1, 1.1}) {
    const Mat3 matrix = in_plane(0.7 * gamma * gamma, 0.0, 0.7 * gamma);
    law.fiber[0] = Vec3::UnitX();
    expect_near(true_stress_free_in_z(law, simple_shear(gamma)), matrix, gamma);
    law.fiber[0] = Vec3::UnitY();  // Becomes (gamma, 1, 0): e = gamma^2.
    const double tension = 2.0 * 0.9 * gamma * gamma * std::exp(0.4 * std::pow(gamma, 4));
    expect_near(true_stress_free_in_z(law, simple_shear(gamma)),
                matrix + tension * in_plane(gamma * gamma, 1.0, gamma), gamma);
  }
}

TEST(HolzapfelGasserOgden, TwoDispersedFamiliesAddUp) {
  const double theta = 0.6;
  const HolzapfelGasserOgden law{.mu_mpa = 0.7,
                                 .k1_mpa = 0.9,
                                 .k2 = 0.4,
                                 .dispersion = 0.2,
                                 .family_count = 2,
                                 .fiber = {Vec3(std::cos(theta), std::sin(theta), 0.0),
                                           Vec3(std::cos(theta), -std::sin(theta), 0.0)}};
  for (const double s : {1.05, 1.3, 1.6}) {
    const Mat3 F = uniaxial(s);
    Mat3 sigma = 0.7 * F * F.transpose() + fiber_stress(law, F, law.fiber[0]) +
                 fiber_stress(law, F, law.fiber[1]);
    sigma -= sigma(2, 2) * Mat3::Identity();
    expect_near(true_stress_free_in_z(law, F), sigma, s);
    EXPECT_NEAR(sigma(0, 1), 0.0, 1e-14);  // The families mirror each other.
  }
}

TEST(HolzapfelGasserOgden, FullyDispersedFibersAreIsotropic) {
  HolzapfelGasserOgden law{.mu_mpa = 0.7, .k1_mpa = 0.9, .k2 = 0.4, .dispersion = 1.0 / 3.0};
  ASSERT_TRUE(law.validate().has_value());
  test::RandomDeformation random(34);
  for (int n = 0; n < 1000; ++n) {
    const Mat3 F = random.kind(n);
    law.fiber[0] = random.rotation().col(0);
    const double energy = law.energy(F);
    law.fiber[0] = random.rotation().col(0);
    ASSERT_NEAR(law.energy(F), energy, 1e-13 * (1.0 + energy)) << "sample " << n;
  }
  const double s = 1.4;  // e = (I1 - 3)/3.
  const double e = (s * s + 2.0 / s - 3.0) / 3.0;
  const double sigma = (0.7 + 2.0 / 3.0 * 0.9 * e * std::exp(0.4 * e * e)) * (s * s - 1.0 / s);
  expect_near(true_stress_free_in_z(law, uniaxial(s)), in_plane(sigma, 0.0, 0.0), s);
}

TEST(HolzapfelGasserOgden, TheSignOfAFiberDoesNotMatter) {
  const auto law = Example<HolzapfelGasserOgden>::law();
  HolzapfelGasserOgden turned = law;
  turned.fiber[0] *= -1.0;
  test::RandomDeformation random(35);
  for (int n = 0; n < 100; ++n) {
    const Mat3 F = random.kind(n);
    EXPECT_EQ(law.energy(F), turned.energy(F));
    EXPECT_EQ(law.stress(F), turned.stress(F));
  }
}

TEST(ExponentialLaws, ReturnInfinityOrNanWhereTheExponentOverflows) {
  const FungOrthotropic fung{.mu_mpa = {1.0, 1.0, 1.0}, .c_mpa = 0.1};
  const HolzapfelGasserOgden fibers{.mu_mpa = 1.0, .k1_mpa = 1.0, .k2 = 40.0};
  for (const double s : {5.0, 1e3, 1e30}) {
    const Mat3 F = uniaxial(s);
    EXPECT_FALSE(std::isfinite(fung.energy(F))) << s;
    EXPECT_FALSE(std::isfinite(fibers.energy(F))) << s;
    EXPECT_FALSE(fung.stress(F).allFinite()) << s;
    EXPECT_FALSE(fibers.stress(F).allFinite()) << s;
  }
}

}  // namespace
}  // namespace lefort::fem::test_material_closed_forms
