#include <lefort/fem/deformation.h>

#include <gtest/gtest.h>

#include "fem/random_deformation.h"

namespace lefort::fem {
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

TEST(Deformation, InvariantsDoNotSeeARotation) {
  test::RandomDeformation random(2);
  const Mat3 F = random.gradient();
  const Mat3 RF = random.rotation() * F;
  EXPECT_NEAR(volume_ratio(RF), volume_ratio(F), 1e-14);
  EXPECT_NEAR(first_invariant(RF), first_invariant(F), 1e-14);
  EXPECT_NEAR(first_invariant(F), right_cauchy_green(F).trace(), 1e-14);
}

TEST(Deformation, CauchyStressOfAStretchIsForceOverDeformedArea) {
  const Mat3 F = Vec3(2.0, 0.5, 0.5).asDiagonal();
  const Mat3 P = Vec3(3.0, 0.0, 0.0).asDiagonal();  // 3 N per mm^2 of reference area.
  EXPECT_NEAR(cauchy_stress(P, F)(0, 0), 3.0 / 0.25, 1e-14);
}

}  // namespace
}  // namespace lefort::fem
