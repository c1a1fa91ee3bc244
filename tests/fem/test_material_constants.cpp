#include <lefort/fem/materials/constants.h>
#include <lefort/fem/materials/material.h>

#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>
#include <limits>
#include <string>

#include "fem/material_examples.h"

namespace lefort::fem::test_material_constants {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

void expect_rejected(const Result<void>& result, const std::string& words) {
  ASSERT_FALSE(result.has_value()) << "wanted: " << words;
  EXPECT_EQ(result.error().code, ErrorCode::kInvalidArgument);
  EXPECT_NE(result.error().message.find(words), std::string::npos) << result.error().message;
}

/// \param member  as in &Yeoh::c10_mpa.
template <class Law>
void expect_member_refused(double Law::*member, std::initializer_list<double> bad,
                           const std::string& words) {
  for (const double value : bad) {
    Law law = test::Example<Law>::law();
    law.*member = value;
    expect_rejected(law.validate(), words);
  }
}

/// The laws made from Young's modulus and Poisson's ratio.
template <class Law>
class LameMaterials : public testing::Test {};
using LameLaws = testing::Types<NeoHookean, LinearElastic, StVenantKirchhoff>;
TYPED_TEST_SUITE(LameMaterials, LameLaws);

TYPED_TEST(LameMaterials, AreMadeFromYoungsModulusAndPoissonsRatio) {
  const auto law = TypeParam::from_young_poisson(2.0, 0.3).value();
  EXPECT_DOUBLE_EQ(law.mu_mpa, 2.0 / 2.6);
  EXPECT_DOUBLE_EQ(law.lambda_mpa, 0.6 / (1.3 * 0.4));
}

TYPED_TEST(LameMaterials, RejectConstantsOutsideTheirRange) {
  for (const double young : {0.0, -1.0, kNan, kInf}) {
    const auto law = TypeParam::from_young_poisson(young, 0.3);
    ASSERT_FALSE(law.has_value());
    EXPECT_EQ(law.error().code, ErrorCode::kInvalidArgument);
    EXPECT_NE(law.error().message.find("young's modulus is"), std::string::npos);
  }
  for (const double poisson : {0.5, 0.7, kInf, -1.0, kNan}) {
    const auto law = TypeParam::from_young_poisson(1.0, poisson);
    ASSERT_FALSE(law.has_value());
    EXPECT_EQ(law.error().code, ErrorCode::kInvalidArgument);
    EXPECT_NE(law.error().message.find("poisson's ratio is"), std::string::npos);
    EXPECT_EQ(law.error().message.find("decoupled law") != std::string::npos, poisson >= 0.5);
  }
  expect_member_refused(&TypeParam::mu_mpa, {0.0, -1.0, kNan, kInf}, ": mu is");
  expect_member_refused(&TypeParam::lambda_mpa, {-1.0, kNan, kInf}, ": lambda is");
}

TEST(NeoHookean, RejectsANegativePoissonsRatio) {
  EXPECT_NE(NeoHookean::from_young_poisson(1.0, -0.1).error().message.find("[0, 0.5)"),
            std::string::npos);
  EXPECT_TRUE(LinearElastic::from_young_poisson(1.0, -0.1).has_value());
}

TEST(DecoupledLaw, RejectsInvalidConstantsOfEitherPart) {
  auto law = test::Example<DecoupledLaw<Yeoh>>::law();
  EXPECT_TRUE(law.validate().has_value());
  law.volume.kappa_mpa = 0.0;
  expect_rejected(law.validate(), "volumetric: kappa is 0 MPa, must be > 0");
  law.isochoric.c10_mpa = kNan;
  expect_rejected(law.validate(), "yeoh: c10 is");
}

TEST(IsochoricLaws, RejectConstantsOutsideTheirRange) {
  expect_member_refused(&IsochoricNeoHookean::mu_mpa, {0.0, -1.0, kNan, kInf},
                        "isochoric neo-hookean: mu is");
  expect_member_refused(&MooneyRivlin::c10_mpa, {-1.0, kNan, kInf}, "mooney-rivlin: c10 is");
  expect_member_refused(&MooneyRivlin::c01_mpa, {-1.0, kNan, kInf}, "mooney-rivlin: c01 is");
  expect_rejected(MooneyRivlin{}.validate(), "mooney-rivlin: c10 + c01 is 0 MPa, must be > 0");
  EXPECT_TRUE((MooneyRivlin{.c10_mpa = 0.0, .c01_mpa = 1.0}.validate().has_value()));
  expect_member_refused(&Yeoh::c10_mpa, {0.0, -1.0, kNan, kInf}, "yeoh: c10 is");
  expect_member_refused(&Yeoh::c20_mpa, {-1.0, kNan, kInf, -kInf}, "yeoh: c20 is");
  expect_member_refused(&Yeoh::c30_mpa, {-1.0, kNan, kInf}, "yeoh: c30 is");
}

TEST(Yeoh, RejectsExactlyTheConstantsThatSoften) {
  const double minimum = -std::sqrt(3.0 * 0.3 * 0.02);
  EXPECT_TRUE((Yeoh{0.3, 0.999 * minimum, 0.02}.validate().has_value()));
  expect_rejected(Yeoh{0.3, 1.001 * minimum, 0.02}.validate(), "c20 is");
  EXPECT_TRUE((Yeoh{0.3, 0.0, 0.0}.validate().has_value()));
  expect_rejected(Yeoh{0.3, -1e-9, 0.0}.validate(), "c20 is");
  // At the bound the min of dPsi/dx is zero.
  const double x = -minimum / (3.0 * 0.02);
  EXPECT_NEAR(0.3 + 2.0 * minimum * x + 3.0 * 0.02 * x * x, 0.0, 1e-15);
}

TEST(Ogden, TheErrorNamesTheInvalidTerm) {
  Ogden law = test::Example<Ogden>::law();
  law.terms[1].mu_mpa = -0.5;
  expect_rejected(law.validate(), "ogden: mu_2 * alpha_2 is -0.5 * 5 = -2.5 MPa, must be > 0");
  law.terms[1] = {};
  EXPECT_TRUE(law.validate().has_value());
  law.terms[1].alpha = 2.0;  // A term without mu.
  expect_rejected(law.validate(), "mu_2 * alpha_2 is 0 * 2");
  for (const double bad : {kNan, kInf}) {
    law.terms[1] = {bad, 2.0};
    expect_rejected(law.validate(), "ogden: mu_2 is");
    law.terms[1] = {2.0, bad};
    expect_rejected(law.validate(), "alpha_2 is");
  }
  expect_rejected(Ogden{}.validate(), "mu_1 * alpha_1 is 0 * 0 = 0 MPa");
}

TEST(FungOrthotropic, RejectsConstantsOutsideTheirRange) {
  const auto good = test::Example<FungOrthotropic>::law();
  expect_member_refused(&FungOrthotropic::c_mpa, {0.0, -1.0, kNan, kInf}, "orthotropic: c is");
  for (const double bad : {0.0, -1.0, kNan, kInf}) {
    FungOrthotropic law = good;
    law.mu_mpa[2] = bad;
    expect_rejected(law.validate(), "fung orthotropic: mu_3 is");
  }
  FungOrthotropic law = good;
  law.lambda_mpa(0, 1) += 1e-3;
  expect_rejected(law.validate(), "must be finite and symmetric");
  law.lambda_mpa.setConstant(kNan);
  expect_rejected(law.validate(), "must be finite and symmetric");
  law = good;
  law.lambda_mpa(0, 0) = -4.0;
  expect_rejected(law.validate(), "must be positive definite");
  law = good;
  law.axes.col(1) *= 1.1;
  expect_rejected(law.validate(), "axis 2 is (");
  law.axes.col(1) = Vec3(good.axes.col(1) + 1e-3 * good.axes.col(0)).normalized();
  expect_rejected(law.validate(), "must be 0");
  law.axes.setConstant(kNan);
  expect_rejected(law.validate(), "must be a unit vector");
}

TEST(HolzapfelGasserOgden, RejectsConstantsOutsideTheirRange) {
  using Law = HolzapfelGasserOgden;
  expect_member_refused(&Law::mu_mpa, {0.0, -1.0, kNan, kInf}, "holzapfel-gasser-ogden: mu is");
  expect_member_refused(&Law::k1_mpa, {-1.0, kNan, kInf}, "holzapfel-gasser-ogden: k1 is");
  expect_member_refused(&Law::k2, {0.0, -1.0, kNan, kInf}, "holzapfel-gasser-ogden: k2 is");
  expect_member_refused(&Law::dispersion, {-0.01, 0.34, kNan}, "dispersion is");
  Law law = test::Example<Law>::law();
  for (const int count : {0, 3, -1}) {
    law.family_count = count;
    expect_rejected(law.validate(), "family_count is");
  }
  law.family_count = 2;
  law.fiber[1] = Vec3(1.0, 1.0, 0.0);
  expect_rejected(law.validate(), "fiber 2 is (1, 1, 0) of length 1.41");
  law.family_count = 1;  // The second family is then unused.
  EXPECT_TRUE(law.validate().has_value());
  law.fiber[0].setConstant(kNan);
  expect_rejected(law.validate(), "fiber 1 is");
}

}  // namespace
}  // namespace lefort::fem::test_material_constants
