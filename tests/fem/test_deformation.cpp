#include <lefort/fem/deformation.h>

#include <gtest/gtest.h>

#include "fem/random_deformation.h"

namespace lefort::fem::test_deformation {
namespace {

TEST(Deformation, FlattenPutsEntryIJAtIPlusThreeJ) {
  Mat3 M;
  M << 0, 3, 6, 1, 4, 7, 2, 5, 8;
  for (int k = 0; k < 9; ++k) EXPECT_EQ(flatten(M)[k], k);
}

TEST(Deformation, ContractIsTheTraceOfTheProduct) {
  test::RandomDeformation random(1);
  const Mat3 A = random.matrix();
  const Mat3 B = random.matrix();
  EXPECT_NEAR(contract(A, B), (A.transpose() * B).trace(), 1e-15);
}

TEST(Deformation, InvariantsDoNotChangeUnderARotation) {
  test::RandomDeformation random(2);
  const Mat3 F = random.gradient();
  const Mat3 RF = random.rotation() * F;
  EXPECT_NEAR(volume_ratio(RF), volume_ratio(F), 1e-14);
  EXPECT_NEAR(first_invariant(RF), first_invariant(F), 1e-14);
  EXPECT_NEAR(first_invariant(F), right_cauchy_green(F).trace(), 1e-14);
}

TEST(Deformation, ASmallChangeOfVolumeIsAccurate) {
  const double h = 1.0 / 1073741824.0;  // 2^-30, exact in F.
  const Mat3 F = (1.0 + h) * Mat3::Identity();
  EXPECT_NEAR(jacobian_minus_one(F), 3.0 * h + 3.0 * h * h + h * h * h, 1e-15 * h);
}

TEST(Deformation, TheCofactorIsTheDerivativeOfTheVolume) {
  test::RandomDeformation random(3);
  for (int n = 0; n < 1000; ++n) {
    const Mat3 F = random.matrix();  // Flat and inverted ones, too.
    const Mat3 dF = random.matrix();
    // J is cubic in the step: differences of step 1 need only the third-order term, det dF.
    const double slope = (volume_ratio(F + dF) - volume_ratio(F - dF)) / 2.0 - dF.determinant();
    EXPECT_NEAR(contract(cofactor(F), dF), slope, 1e-14);
    const Mat3 change = (cofactor(F + dF) - cofactor(F - dF)) / 2.0;  // Quadratic: exact.
    const Mat9 A = cofactor_tangent(F);
    EXPECT_LT((A * flatten(dF) - flatten(change)).norm(), 1e-14);
    EXPECT_EQ(A, A.transpose());
  }
}

TEST(Deformation, CauchyStressOfAStretchIsForceOverDeformedArea) {
  const Mat3 F = Vec3(2.0, 0.5, 0.5).asDiagonal();
  const Mat3 P = Vec3(3.0, 0.0, 0.0).asDiagonal();  // 3 N per mm^2 of reference area.
  EXPECT_NEAR(cauchy_stress(P, F)(0, 0), 3.0 / 0.25, 1e-14);
}

}  // namespace
}  // namespace lefort::fem::test_deformation
