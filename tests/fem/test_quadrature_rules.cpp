#include <lefort/fem/elements/quadrature_rules.h>

#include <gtest/gtest.h>

#include <cmath>

namespace lefort::fem::test_quadrature_rules {
namespace {

/// The integral of xi^i eta^j over the triangle is i! j! / (i + j + 2)!.
template <class Points>
void expect_exact_to_degree(const Points& points, int degree) {
  for (int i = 0; i <= degree; ++i)
    for (int j = 0; i + j <= degree; ++j) {
      double sum = 0.0;
      for (const auto& point : points)
        sum += point.weight * std::pow(point.xi[0], i) * std::pow(point.xi[1], j);
      const double exact = std::tgamma(i + 1) * std::tgamma(j + 1) / std::tgamma(i + j + 3);
      EXPECT_NEAR(sum, exact, 1e-15) << "xi^" << i << " eta^" << j;
    }
}

TEST(QuadratureRules, OfTheTriangleAreExactToTheirDegree) {
  expect_exact_to_degree(triangle_3(), 2);
  expect_exact_to_degree(triangle_6(), 4);
  expect_exact_to_degree(triangle_12(), 6);
}

TEST(QuadratureRules, OfTheTriangleHavePositiveWeightsAndPointsInside) {
  for (const auto& point : triangle_12()) {
    EXPECT_GT(point.weight, 0.0);
    EXPECT_GT(point.xi.minCoeff(), 0.0);
    EXPECT_LT(point.xi.sum(), 1.0);
  }
}

}  // namespace
}  // namespace lefort::fem::test_quadrature_rules
