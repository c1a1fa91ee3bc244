#include <lefort/fem/material.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "fem/random_deformation.h"

namespace lefort::fem {
namespace {

constexpr int kSamples = 500;
constexpr double kStep = 1e-5;  // Central differences: error about kStep^2 + 1e-16 / kStep.

template <class Law>
Law example();

template <>
NeoHookean example() {
  return {.mu_mpa = 0.7, .lambda_mpa = 2.9};
}

template <>
LinearElastic example() {
  return {.mu_mpa = 0.7, .lambda_mpa = 2.9};
}

template <>
Split<IsochoricNeoHookean> example() {
  return {.shear = {.mu_mpa = 0.7},
          .volume = {.form = VolumetricForm::kQuadraticLog, .kappa_mpa = 3.1}};
}

/// What every law must fulfil.
template <class Law>
class AllMaterials : public testing::Test {};
using Laws = testing::Types<NeoHookean, LinearElastic, Split<IsochoricNeoHookean>>;
TYPED_TEST_SUITE(AllMaterials, Laws);

TYPED_TEST(AllMaterials, NoEnergyAndNoStressAtRest) {
  const auto law = example<TypeParam>();
  EXPECT_EQ(law.energy(Mat3::Identity()), 0.0);
  EXPECT_EQ(law.stress(Mat3::Identity()).norm(), 0.0);
}

TYPED_TEST(AllMaterials, StressIsTheDerivativeOfTheEnergy) {
  const auto law = example<TypeParam>();
  test::RandomDeformation random(11);
  for (int n = 0; n < kSamples; ++n) {
    const Mat3 F = random.gradient();
    const Mat3 dF = random.matrix();
    const double difference = (law.energy(F + kStep * dF) - law.energy(F - kStep * dF)) / 2 / kStep;
    EXPECT_NEAR(contract(law.stress(F), dF), difference, 1e-7 * (1.0 + law.stress(F).norm()))
        << "sample " << n;
  }
}

TYPED_TEST(AllMaterials, TangentIsTheDerivativeOfTheStress) {
  const auto law = example<TypeParam>();
  test::RandomDeformation random(12);
  for (int n = 0; n < kSamples; ++n) {
    const Mat3 F = random.gradient();
    const Mat3 dF = random.matrix();
    const Mat3 difference = (law.stress(F + kStep * dF) - law.stress(F - kStep * dF)) / 2 / kStep;
    const Mat9 A = law.tangent(F);
    EXPECT_LT((A * flatten(dF) - flatten(difference)).norm(), 1e-7 * (1.0 + A.norm()))
        << "sample " << n;
    EXPECT_LT((A - A.transpose()).norm(), 1e-13 * A.norm()) << "sample " << n;
  }
}

/// The laws made from Lame's constants.
template <class Law>
class LameMaterials : public testing::Test {};
using LameLaws = testing::Types<NeoHookean, LinearElastic>;
TYPED_TEST_SUITE(LameMaterials, LameLaws);

TYPED_TEST(LameMaterials, IsHookesLawAtSmallStrain) {
  const auto law = TypeParam::from_young_poisson(2.0, 0.3).value();
  test::RandomDeformation random(13);
  const Mat3 strain = 1e-6 * (random.matrix() + random.matrix().transpose());
  const Mat3 symmetric = 0.5 * (strain + strain.transpose());
  const Mat3 hooke = 2.0 / 1.3 * (symmetric + 0.3 / 0.4 * symmetric.trace() * Mat3::Identity());
  const Mat3 F = Mat3::Identity() + symmetric;
  EXPECT_LT((law.stress(F) - hooke).norm(), 1e-5 * hooke.norm());
  // An energy of 1e-12 MPa still has its digits.
  EXPECT_NEAR(law.energy(F), 0.5 * contract(hooke, symmetric), 1e-4 * law.energy(F));
}

TYPED_TEST(LameMaterials, RefusesConstantsOutsideTheirRange) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInf = std::numeric_limits<double>::infinity();
  for (const double young : {0.0, -1.0, kNan, kInf}) {
    const auto law = TypeParam::from_young_poisson(young, 0.3);
    ASSERT_FALSE(law.has_value());
    EXPECT_EQ(law.error().code, ErrorCode::kInvalidArgument);
    EXPECT_NE(law.error().message.find("young's modulus is"), std::string::npos);
  }
  for (const double poisson : {0.5, 0.7, -1.0, kNan})
    EXPECT_EQ(TypeParam::from_young_poisson(1.0, poisson).error().code,
              ErrorCode::kInvalidArgument);
  for (const double bad : {-1.0, kNan, kInf}) {
    EXPECT_EQ((TypeParam{.mu_mpa = bad, .lambda_mpa = 1.0}.validate().error().code),
              ErrorCode::kInvalidArgument);
    EXPECT_EQ((TypeParam{.mu_mpa = 1.0, .lambda_mpa = bad}.validate().error().code),
              ErrorCode::kInvalidArgument);
  }
  EXPECT_TRUE(example<TypeParam>().validate().has_value());
}

TEST(NeoHookean, ARotationStoresNoEnergyAndTurnsTheStress) {
  const auto law = example<NeoHookean>();
  test::RandomDeformation random(14);
  for (int n = 0; n < kSamples; ++n) {
    const Mat3 R = random.rotation();
    const Mat3 F = random.gradient();
    EXPECT_NEAR(law.energy(R), 0.0, 1e-14);
    EXPECT_LT(law.stress(R).norm(), 1e-14);
    EXPECT_NEAR(law.energy(R * F), law.energy(F), 1e-13 * (1.0 + law.energy(F)));
    EXPECT_LT((law.stress(R * F) - R * law.stress(F)).norm(), 1e-12 * (1.0 + law.stress(F).norm()));
    EXPECT_NEAR(law.energy(F * R), law.energy(F), 1e-13 * (1.0 + law.energy(F)));  // Isotropic.
  }
}

TEST(NeoHookean, SimpleShearMatchesTheTextbook) {
  const NeoHookean law{.mu_mpa = 0.5, .lambda_mpa = 10.0};
  const double gamma = 0.8;
  Mat3 F = Mat3::Identity();
  F(0, 1) = gamma;
  const Mat3 sigma = cauchy_stress(law.stress(F), F);
  Mat3 expected = Mat3::Zero();  // mu (F F^T - I): J = 1, no pressure.
  expected(0, 1) = expected(1, 0) = 0.5 * gamma;
  expected(0, 0) = 0.5 * gamma * gamma;
  EXPECT_LT((sigma - expected).norm(), 1e-15);
  EXPECT_NEAR(law.energy(F), 0.25 * gamma * gamma, 1e-15);
}

TEST(NeoHookean, UniformExpansionMatchesTheClosedForm) {
  const NeoHookean law{.mu_mpa = 0.5, .lambda_mpa = 10.0};
  const double s = 1.3;
  const Mat3 sigma = cauchy_stress(law.stress(s * Mat3::Identity()), s * Mat3::Identity());
  const double pressure = (0.5 * (s * s - 1.0) + 10.0 * 3.0 * std::log(s)) / (s * s * s);
  EXPECT_LT((sigma - pressure * Mat3::Identity()).norm(), 1e-13);
}

}  // namespace
}  // namespace lefort::fem
