#include <lefort/linear/gmres.h>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <limits>

#include "linear/sparse_examples.h"

namespace lefort::linear::test_gmres {
namespace {

constexpr Index kSize = 60;

/// A positive definite matrix plus an antisymmetric one of the same size.
Eigen::MatrixXd unsymmetric(const Eigen::MatrixXd& K) {
  const Eigen::MatrixXd L = K.triangularView<Eigen::StrictlyLower>();
  return K + 3.0 * (L - L.transpose());
}

TEST(Gmres, SolvesANonsymmetricSystemWithItsSymmetricPartAsPreconditioner) {
  const Eigen::MatrixXd K = test::random_positive_definite(kSize, 0.04, 0.1, 1);
  const Eigen::MatrixXd A = unsymmetric(K);
  const Eigen::LLT<Eigen::MatrixXd> factor(K);
  const VectorX b = VectorX::LinSpaced(kSize, -1.0, 2.0);
  int products = 0;
  const auto solve = [&](double tolerance, int maximum) {
    products = 0;
    return solve_by_gmres(
        [&](const VectorX& x) {
          ++products;
          return VectorX(A * x);
        },
        [&](const VectorX& r) { return std::optional<VectorX>(factor.solve(r)); }, b, tolerance,
        maximum);
  };
  const auto rough = solve(1e-3, kSize);
  ASSERT_TRUE(rough.has_value());
  EXPECT_LE(rough->relative_residual, 1e-3);
  EXPECT_NEAR((A * rough->x - b).norm(), rough->relative_residual * b.norm(), 1e-9 * b.norm());
  const int few = products;
  const auto x = solve(1e-12, kSize);
  ASSERT_TRUE(x.has_value());
  EXPECT_LE((A * x->x - b).norm(), 2e-12 * b.norm());
  EXPECT_GT(products, few);
  EXPECT_EQ(solve(1e-12, few)->x, rough->x);
}

TEST(Gmres, AZeroRightSideGivesZeroAndFailuresAreReturned) {
  const auto same = [](const VectorX& x) { return x; };
  const auto fails = [](const VectorX&) { return std::optional<VectorX>(); };
  EXPECT_TRUE(solve_by_gmres(same, fails, VectorX::Zero(3), 1e-6, 5)->x.isZero(0.0));
  EXPECT_FALSE(solve_by_gmres(same, fails, VectorX::Ones(3), 1e-6, 5).has_value());
  const auto broken = [](const VectorX& x) {
    return VectorX(std::numeric_limits<double>::quiet_NaN() * x);
  };
  const auto keeps = [](const VectorX& r) { return std::optional<VectorX>(r); };
  EXPECT_FALSE(solve_by_gmres(broken, keeps, VectorX::Ones(3), 1e-6, 5).has_value());
  EXPECT_TRUE(solve_by_gmres(same, keeps, VectorX::Ones(3), 1e-6, 5)->x.isOnes(1e-15));
}

}  // namespace
}  // namespace lefort::linear::test_gmres
