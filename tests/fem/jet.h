/// \file
/// Numbers with first and second derivatives (automatic differentiation).
#pragma once

#include <lefort/fem/deformation.h>

#include <cmath>

namespace lefort::test {

/// A value with its gradient and Hessian in nine variables: the entries of F in the order of
/// flatten().
struct Jet {
  Jet() = default;
  explicit Jet(double constant) : value(constant) {}

  double value = 0.0;
  fem::Vec9 gradient = fem::Vec9::Zero();
  fem::Mat9 hessian = fem::Mat9::Zero();
};

/// \returns f(x), given f, f' and f'' at x.value.
inline Jet chain(const Jet& x, double f, double df, double ddf) {
  Jet y(f);
  y.gradient = df * x.gradient;
  y.hessian = df * x.hessian + ddf * x.gradient * x.gradient.transpose();
  return y;
}

inline Jet operator+(const Jet& a, const Jet& b) {
  Jet sum(a.value + b.value);
  sum.gradient = a.gradient + b.gradient;
  sum.hessian = a.hessian + b.hessian;
  return sum;
}

inline Jet operator-(const Jet& a) { return chain(a, -a.value, -1.0, 0.0); }
inline Jet operator-(const Jet& a, const Jet& b) { return a + (-b); }

inline Jet operator*(const Jet& a, const Jet& b) {
  Jet product(a.value * b.value);
  product.gradient = a.value * b.gradient + b.value * a.gradient;
  product.hessian = a.value * b.hessian + b.value * a.hessian +
                    a.gradient * b.gradient.transpose() + b.gradient * a.gradient.transpose();
  return product;
}

inline Jet operator/(const Jet& a, const Jet& b) {
  const double inverse = 1.0 / b.value;
  return a * chain(b, inverse, -inverse * inverse, 2.0 * inverse * inverse * inverse);
}

inline Jet exp(const Jet& x) {
  const double e = std::exp(x.value);
  return chain(x, e, e, e);
}

inline Jet log(const Jet& x) {
  return chain(x, std::log(x.value), 1.0 / x.value, -1.0 / (x.value * x.value));
}

inline bool operator>(const Jet& a, const Jet& b) { return a.value > b.value; }

}  // namespace lefort::test
