/// \file
/// Quadrature rules of elements and faces, and their products.
#pragma once

#include <lefort/fem/elements/quadrature_point.h>

#include <cmath>

namespace lefort::fem {

/// Gauss rule on [-1, 1] with two points, exact to degree 3 (\cite hughes2000, section 3.8).
[[nodiscard]] inline Rule<1, 2> gauss_2() {
  using Xi = Eigen::Matrix<double, 1, 1>;
  const double g = 1.0 / std::sqrt(3.0);
  return {{{Xi(-g), 1.0}, {Xi(g), 1.0}}};
}

/// Gauss rule on [-1, 1] with three points, exact to degree 5.
[[nodiscard]] inline Rule<1, 3> gauss_3() {
  using Xi = Eigen::Matrix<double, 1, 1>;
  const double g = std::sqrt(0.6);
  return {{{Xi(-g), 5.0 / 9.0}, {Xi(0.0), 8.0 / 9.0}, {Xi(g), 5.0 / 9.0}}};
}

/// Three interior points of the triangle xi, eta >= 0, xi + eta <= 1, exact to degree 2
/// (\cite hammer1956).
[[nodiscard]] inline Rule<2, 3> triangle_3() {
  constexpr double kNear = 2.0 / 3.0, kFar = 1.0 / 6.0, kWeight = 1.0 / 6.0;
  return {{{{kFar, kFar}, kWeight}, {{kNear, kFar}, kWeight}, {{kFar, kNear}, kWeight}}};
}

/// Six points of the same triangle, exact to degree 4 (\cite dunavant1985, there as decimals).
[[nodiscard]] inline Rule<2, 6> triangle_6() {
  const double root = std::sqrt(38.0 - 44.0 * std::sqrt(0.4));
  const double weight_root = std::sqrt(213125.0 - 53320.0 * std::sqrt(10.0));
  Rule<2, 6> rule;
  for (const std::size_t orbit : {0, 1}) {
    const double sign = orbit == 0 ? 1.0 : -1.0;
    const double far = (8.0 - std::sqrt(10.0) + sign * root) / 18.0;
    const double near = 1.0 - 2.0 * far;
    const double weight = 0.5 * (620.0 + sign * weight_root) / 3720.0;
    rule[3 * orbit] = {{far, far}, weight};
    rule[3 * orbit + 1] = {{near, far}, weight};
    rule[3 * orbit + 2] = {{far, near}, weight};
  }
  return rule;
}

/// Twelve points of the same triangle, exact to degree 6 (\cite dunavant1985).
[[nodiscard]] inline Rule<2, 12> triangle_12() {
  struct Orbit {
    double a, b, weight;  ///< Barycentric coordinates a, b, 1 - a - b; all weights sum to one.
  };
  constexpr Orbit kInner{0.249286745170910421, 0.249286745170910421, 0.116786275726379366};
  constexpr Orbit kOuter{0.063089014491502227, 0.063089014491502227, 0.050844906370206817};
  constexpr Orbit kSix{0.053145049844816947, 0.310352451033784405, 0.082851075618373575};
  Rule<2, 12> rule;
  std::size_t q = 0;
  const auto add = [&](double xi, double eta, double weight) {
    rule[q++] = {{xi, eta}, 0.5 * weight};
  };
  for (const Orbit& orbit : {kInner, kOuter, kSix}) {
    const auto& [a, b, weight] = orbit;
    const double c = 1.0 - a - b;
    add(a, b, weight);
    add(b, c, weight);
    add(c, a, weight);
  }
  const auto& [a, b, weight] = kSix;
  const double c = 1.0 - a - b;
  add(b, a, weight);
  add(a, c, weight);
  add(c, b, weight);
  return rule;
}

/// \returns the rule on the product of two reference elements; the coordinates of `b` come
///   last.
template <int kDimA, std::size_t kCountA, int kDimB, std::size_t kCountB>
[[nodiscard]] Rule<kDimA + kDimB, kCountA * kCountB> product(const Rule<kDimA, kCountA>& a,
                                                             const Rule<kDimB, kCountB>& b) {
  Rule<kDimA + kDimB, kCountA * kCountB> rule;
  std::size_t q = 0;
  for (const RulePoint<kDimB>& of_b : b)
    for (const RulePoint<kDimA>& of_a : a) {
      rule[q].xi << of_a.xi, of_b.xi;
      rule[q++].weight = of_a.weight * of_b.weight;
    }
  return rule;
}

}  // namespace lefort::fem
