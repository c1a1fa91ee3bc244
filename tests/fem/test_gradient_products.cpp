#include <lefort/fem/elements/gradient_products.h>

#include <gtest/gtest.h>

#include <cmath>

namespace lefort::fem::test_gradient_products {
namespace {

constexpr double kRoundOff = 1e-13;

/// Numbers without pattern.
template <int kRows, int kColumns>
Eigen::Matrix<double, kRows, kColumns> numbers(double seed) {
  return Eigen::Matrix<double, kRows, kColumns>::NullaryExpr(
      [seed](Index i, Index j) { return std::sin(seed + 7.3 * double(i) + 3.1 * double(j)); });
}

template <int kNodes>
void compare_with_eigen() {
  const auto x = numbers<3, kNodes>(1.0), g = numbers<3, kNodes>(2.0);
  const Mat3 M = numbers<3, 3>(3.0);
  EXPECT_TRUE(sum_of_dyads<kNodes>(x.data(), g.data()).isApprox(x * g.transpose(), kRoundOff));
  Eigen::Matrix<double, 3, kNodes> product;
  multiply_columns(M, g.data(), kNodes, product.data());
  EXPECT_TRUE(product.isApprox(M * g, kRoundOff));
  multiply_columns_transposed(M, g.data(), kNodes, product.data());
  EXPECT_TRUE(product.isApprox(M.transpose() * g, kRoundOff));
}

TEST(GradientProducts, AreThoseOfEigen) {
  compare_with_eigen<4>();
  compare_with_eigen<5>();
  compare_with_eigen<10>();
  compare_with_eigen<15>();
  compare_with_eigen<20>();
}

/// K_(ai)(bj) = sum over J, L of g_a[J] A_(iJ)(jL) g_b[L] dV, added to what is there.
TEST(GradientProducts, StiffnessOfAPoint) {
  constexpr int kNodes = 5, kSize = 15;
  constexpr double kVolume = 0.7;
  const auto g = numbers<3, kNodes>(4.0);
  const Mat9 half = numbers<9, 9>(5.0), A = half + half.transpose();
  Eigen::Matrix<double, kSize, kSize> K = Eigen::Matrix<double, kSize, kSize>::Ones();
  Eigen::Matrix<double, kSize, kSize> expected = K;
  for (int a = 0; a < kNodes; ++a)
    for (int b = 0; b < kNodes; ++b)
      for (int J = 0; J < 3; ++J)
        for (int L = 0; L < 3; ++L)
          expected.block<3, 3>(3 * a, 3 * b) +=
              kVolume * g(J, a) * g(L, b) * A.block<3, 3>(3 * J, 3 * L);
  add_point_stiffness(A, kVolume, g.data(), kNodes, K.data());
  EXPECT_TRUE(K.isApprox(expected, kRoundOff));
}

TEST(GradientProducts, LowRankProduct) {
  const auto a = numbers<12, 4>(6.0), b = numbers<12, 4>(7.0);
  Eigen::Matrix<double, 12, 12> K = Eigen::Matrix<double, 12, 12>::Identity();
  add_low_rank_product(a.data(), b.data(), 12, 4, K.data());
  EXPECT_TRUE(K.isApprox(Eigen::Matrix<double, 12, 12>::Identity() + a * b.transpose(), kRoundOff));
}

}  // namespace
}  // namespace lefort::fem::test_gradient_products
