#include <lefort/fem/materials/material.h>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <gtest/gtest.h>

#include <cmath>
#include <type_traits>
#include <variant>

#include "fem/jet.h"
#include "fem/material_examples.h"
#include "fem/random_deformation.h"
#include "fem/textbook_energy.h"

namespace lefort::fem::test_materials {
namespace {

using test::Example;
using test::Jet;
using test::Matrix;

constexpr int kSamples = 2000;

/// Tolerance of stresses and tangents, relative to the norm of the tangent.
constexpr double kPrecision = 1e-13;

/// F as nine variables.
Matrix<Jet> variables(const Mat3& F) {
  return test::filled<Jet>([&](int i, int j) {
    Jet entry(F(i, j));
    entry.gradient[i + 3 * j] = 1.0;
    return entry;
  });
}

/// \returns whether the energy has a second derivative near F: not where a fiber is just taut.
template <class Law>
bool is_smooth_near(const Law& /*law*/, const Mat3& /*F*/, double /*distance*/) {
  return true;
}

bool is_smooth_near(const DecoupledLaw<HolzapfelGasserOgden>& law, const Mat3& F, double distance) {
  for (int n = 0; n < law.isochoric.family_count; ++n)
    if (std::abs(test::textbook_fiber_strain(law.isochoric, n, variables(F)).value) < distance)
      return false;
  return true;
}

/// Properties of every law.
template <class Law>
class AllMaterials : public testing::Test {};
TYPED_TEST_SUITE(AllMaterials, test::AllLaws);

TYPED_TEST(AllMaterials, NoEnergyAndNoStressAtRest) {
  const auto law = Example<TypeParam>::law();
  EXPECT_TRUE(law.validate().has_value());
  EXPECT_EQ(law.energy(Mat3::Identity()), 0.0);
  EXPECT_EQ(law.stress(Mat3::Identity()).norm(), 0.0);
}

TYPED_TEST(AllMaterials, EnergyStressAndTangentAreThoseOfTheTextbookEnergy) {
  const auto law = Example<TypeParam>::law();
  test::RandomDeformation random(11);
  for (int n = 0; n < kSamples; ++n) {
    const Mat3 F = random.kind(n);
    const Jet expected = test::textbook_energy(law, variables(F));
    const Mat9 A = law.tangent(F);
    const double tolerance = kPrecision * A.norm();
    ASSERT_NEAR(law.energy(F), expected.value, tolerance) << "sample " << n << "\n" << F;
    ASSERT_LT((flatten(law.stress(F)) - expected.gradient).norm(), tolerance)
        << "sample " << n << "\n"
        << F;
    if (!is_smooth_near(law, F, 1e-12)) continue;
    ASSERT_LT((A - expected.hessian).norm(), tolerance) << "sample " << n << "\n" << F;
    ASSERT_LT((A - A.transpose()).norm(), tolerance) << "sample " << n << "\n" << F;
  }
}

TYPED_TEST(AllMaterials, StressAndTangentAreFiniteDifferencesOfEnergyAndStress) {
  // Finite differences, independent of Jet.
  constexpr double kStep = 1e-5;
  const auto law = Example<TypeParam>::law();
  test::RandomDeformation random(12);
  for (int n = 0; n < kSamples; ++n) {
    const Mat3 F = random.kind(n);
    if (!is_smooth_near(law, F, 20.0 * kStep)) continue;
    const Mat3 dF = random.matrix();
    const Mat9 A = law.tangent(F);
    const double slope = (law.energy(F + kStep * dF) - law.energy(F - kStep * dF)) / 2 / kStep;
    const Mat3 change = (law.stress(F + kStep * dF) - law.stress(F - kStep * dF)) / 2 / kStep;
    ASSERT_NEAR(contract(law.stress(F), dF), slope, 1e-6 * A.norm()) << "sample " << n;
    ASSERT_LT((A * flatten(dF) - flatten(change)).norm(), 1e-6 * A.norm()) << "sample " << n;
  }
}

TYPED_TEST(AllMaterials, IsHookesLawAtSmallStrain) {
  const auto law = Example<TypeParam>::law();
  test::RandomDeformation random(13);
  for (int n = 0; n < kSamples; ++n) {
    const Mat3 M = random.matrix();
    const Mat3 F = Mat3::Identity() + 1e-6 * (M + M.transpose());
    const Mat3 eps = F - Mat3::Identity();
    const double expected = Example<TypeParam>::small_strain_energy(law, eps);
    // An energy of 1e-12 MPa is accurate.
    ASSERT_NEAR(law.energy(F), expected, 1e-4 * expected) << "sample " << n;
    ASSERT_NEAR(contract(law.stress(F), eps), 2.0 * expected, 1e-4 * expected) << "sample " << n;
  }
}

TYPED_TEST(AllMaterials, EnergyIncreasesWithStretchAndCompression) {
  const auto law = Example<TypeParam>::law();
  test::RandomDeformation random(14);
  for (int n = 0; n < 100; ++n) {
    const Mat3 R = random.rotation();
    const auto energy = [&](double s) {
      const Vec3 stretches(s, 1.0 / std::sqrt(s), 1.0 / std::sqrt(s));
      return law.energy(R * stretches.asDiagonal() * R.transpose());
    };
    for (double s = 1.0; s < 3.0; s *= 1.05) {
      ASSERT_GT(energy(1.05 * s), energy(s)) << s;
      ASSERT_GT(energy(1.0 / (1.05 * s)), energy(1.0 / s)) << s;
    }
  }
}

/// Compared with the textbook energy, with eighty digits.
template <class Law>
double relative_error_of_energy(const Law& law, const Mat3& F) {
  using Exact = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<80>,
                                              boost::multiprecision::et_off>;
  const auto exact_F = test::filled<Exact>([&](int i, int j) { return Exact(F(i, j)); });
  const Exact exact = test::textbook_energy(law, exact_F);
  return std::abs(double((Exact(law.energy(F)) - exact) / exact));
}

/// Whether terms of first order in the strain, which add to zero, are omitted from the energy.
template <class Law>
constexpr bool kKeepsDigits = !std::is_same_v<Law, NeoHookean>;

TYPED_TEST(AllMaterials, EnergiesOfTinyStrainsAreAccurate) {
  const auto law = Example<TypeParam>::law();
  test::RandomDeformation random(15);
  for (double size = 0.3; size > 1e-12; size *= 0.3) {
    for (int n = 0; n < 20; ++n) {
      const Mat3 F = Mat3::Identity() + size * random.matrix();
      if (!(volume_ratio(F) > 0.1)) continue;
      ASSERT_LT(relative_error_of_energy(law, F),
                (kKeepsDigits<TypeParam> ? 1e-13 : 1e-14 + 1e-15 / size))
          << "strain " << size << "\n"
          << F;
    }
  }
}

/// Properties of every law except the linear one.
template <class Law>
class ObjectiveMaterials : public testing::Test {};
template <class List>
struct WithoutLinear;
template <class A, class B, class... Others>
struct WithoutLinear<testing::Types<A, B, Others...>> {
  static_assert(std::is_same_v<B, LinearElastic>);
  using Types = testing::Types<A, Others...>;
};
TYPED_TEST_SUITE(ObjectiveMaterials, WithoutLinear<test::AllLaws>::Types);

TYPED_TEST(ObjectiveMaterials, ARotationOfTheBodyRotatesTheStressOnly) {
  const auto law = Example<TypeParam>::law();
  test::RandomDeformation random(16);
  for (int n = 0; n < kSamples; ++n) {
    const Mat3 R = random.rotation();
    const Mat3 F = random.kind(n);
    const double tolerance = kPrecision * law.tangent(F).norm();
    ASSERT_NEAR(law.energy(R), 0.0, kKeepsDigits<TypeParam> ? 1e-28 : 1e-14);
    ASSERT_LT(law.stress(R).norm(), 1e-14);
    ASSERT_NEAR(law.energy(R * F), law.energy(F), tolerance) << "sample " << n;
    ASSERT_LT((law.stress(R * F) - R * law.stress(F)).norm(), tolerance) << "sample " << n;
  }
}

TYPED_TEST(ObjectiveMaterials, ARotationInTheMaterialSymmetryHasNoEffect) {
  const auto law = Example<TypeParam>::law();
  test::RandomDeformation random(17);
  for (int n = 0; n < kSamples; ++n) {
    const Mat3 R = Example<TypeParam>::symmetry(law, random);
    const Mat3 F = random.kind(n);
    const double tolerance = kPrecision * law.tangent(F).norm();
    ASSERT_NEAR(law.energy(F * R), law.energy(F), tolerance) << "sample " << n;
    ASSERT_LT((law.stress(F * R) - law.stress(F) * R).norm(), tolerance) << "sample " << n;
  }
}

/// Properties of every isochoric law.
template <class Law>
class IsochoricLaws : public testing::Test {};
TYPED_TEST_SUITE(IsochoricLaws, test::IsochoricExamples);

TYPED_TEST(IsochoricLaws, DoNotDependOnVolume) {
  const auto law = Example<TypeParam>::law();
  test::RandomDeformation random(18);
  for (int n = 0; n < kSamples; ++n) {
    const Mat3 F = random.kind(n);
    const double s = random.stretch();
    const double tolerance = kPrecision * law.tangent(F).norm();
    ASSERT_NEAR(law.energy(s * F), law.energy(F), tolerance) << "sample " << n;
    ASSERT_NEAR(contract(law.stress(F), F), 0.0, tolerance) << "sample " << n;
    ASSERT_LT(law.stress(s * Mat3::Identity()).norm(), 1e-14);
  }
}

TYPED_TEST(IsochoricLaws, ArePartsOfADecoupledLaw) {
  static_assert(kIsDecoupled<DecoupledLaw<TypeParam>>);
  static_assert(!kIsDecoupled<TypeParam>);
  static_assert(!kIsDecoupled<NeoHookean>);
  EXPECT_TRUE(
      (std::holds_alternative<DecoupledLaw<TypeParam>>(Material(DecoupledLaw<TypeParam>()))));
}

TYPED_TEST(IsochoricLaws, HaveTheirEnergyAtExtremeStretches) {
  const auto law = Example<TypeParam>::law();
  // Ogden's principal stretches are computed from C - I, which is inaccurate for stretches near
  // zero.
  const double precision = std::is_same_v<TypeParam, Ogden> ? 1e-7 : 1e-10;
  test::RandomDeformation random(19);
  for (const double s : {1e-4, 1e-3, 1e-2, 0.1, 10.0, 100.0}) {
    for (int n = 0; n < 10; ++n) {
      const Mat3 F = random.rotation() * Vec3(s, 1.0, 1.0).asDiagonal() * random.rotation();
      if (!std::isfinite(law.energy(F))) continue;
      ASSERT_LT(relative_error_of_energy(law, F), precision) << "stretch " << s;
    }
  }
}

TYPED_TEST(IsochoricLaws, AreNotFiniteBeyondTheRangeOfNumbers) {
  // The energy must increase towards inversion.
  const auto law = Example<TypeParam>::law();
  for (const double s : {1e-90, 1e90})
    EXPECT_FALSE(law.energy(Vec3(s, 1.0, 1.0).asDiagonal()) < 1e6) << s;
}

}  // namespace
}  // namespace lefort::fem::test_materials
