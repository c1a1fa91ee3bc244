#include <lefort/core/decompositions.h>

#include <gtest/gtest.h>

#include <cmath>

namespace lefort::test_decompositions {
namespace {

constexpr double kRoundOff = 1e-13;

Mat3 example() { return (Mat3() << 4, 1, -2, 1, 3, 0.5, -2, 0.5, 5).finished(); }

TEST(Decompositions, SymmetricEigenpairs) {
  const auto [values, vectors] = symmetric_eigen(example());
  EXPECT_TRUE((example() * vectors).isApprox(vectors * values.asDiagonal(), kRoundOff));
  EXPECT_TRUE((vectors.transpose() * vectors).isApprox(Mat3::Identity(), kRoundOff));
  EXPECT_LT(values[0], values[1]);
  EXPECT_LT(values[1], values[2]);
}

/// The second difference: eigenvalues 2 - 2 cos(k pi / 5).
TEST(Decompositions, TridiagonalEigenvaluesInClosedForm) {
  const auto [values, vectors] = tridiagonal_eigen(Eigen::Vector4d::Constant(2.0), -Vec3::Ones());
  for (int k = 0; k < 4; ++k)
    EXPECT_NEAR(values[k], 2.0 - 2.0 * std::cos((k + 1) * M_PI / 5.0), kRoundOff);
  EXPECT_TRUE((vectors.transpose() * vectors).isApprox(Eigen::Matrix4d::Identity(), kRoundOff));
}

TEST(Decompositions, SingularValuesOfAnyMatrix) {
  const Mat3 A = (Mat3() << 1, 2, 3, 0, -1, 4, 2, 2, -5).finished();
  const auto [U, values, V] = singular_value_decomposition(A);
  EXPECT_TRUE((U * values.asDiagonal() * V.transpose()).isApprox(A, kRoundOff));
  EXPECT_TRUE(singular_values(A).isApprox(values, kRoundOff));
  EXPECT_GE(values[0], values[1]);
  EXPECT_GE(values[2], 0.0);
}

TEST(Decompositions, LinearSystems) {
  const Vec3 b(1, -2, 3);
  EXPECT_TRUE((example() * solve_by_lu(example(), b)).isApprox(b, kRoundOff));
  EXPECT_FALSE(solve_by_lu(Mat3::Zero(), b).allFinite());
  const Eigen::Matrix2d singular = (Eigen::Matrix2d() << 1, 2, 2, 4).finished();
  const Eigen::Vector2d of_range(1, 2);
  EXPECT_TRUE((singular * solve_by_full_lu(singular, of_range)).isApprox(of_range, kRoundOff));
}

}  // namespace
}  // namespace lefort::test_decompositions
