/// \file
/// Independent energies of all laws as in the textbooks, without measures for accuracy or
/// derivatives by hand, for any number type: Jet gives exact derivatives, Boost eighty digits.
#pragma once

#include <lefort/fem/materials/material.h>

#include <array>
#include <cmath>
#include <type_traits>

#include "fem/jet.h"

namespace lefort::test {

template <class T>
using Matrix = std::array<std::array<T, 3>, 3>;

template <class T>
Matrix<T> filled(auto&& entry) {
  Matrix<T> M;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) M[std::size_t(i)][std::size_t(j)] = entry(i, j);
  return M;
}

template <class T>
T at(const Matrix<T>& M, int i, int j) {
  return M[std::size_t(i)][std::size_t(j)];
}

template <class T>
T trace(const Matrix<T>& M) {
  return M[0][0] + M[1][1] + M[2][2];
}

template <class T>
Matrix<T> product(const Matrix<T>& A, const Matrix<T>& B) {
  return filled<T>([&](int i, int j) {
    return at(A, i, 0) * at(B, 0, j) + at(A, i, 1) * at(B, 1, j) + at(A, i, 2) * at(B, 2, j);
  });
}

template <class T>
Matrix<T> sum(const T& a, const Matrix<T>& A, const T& b, const Matrix<T>& B) {
  return filled<T>([&](int i, int j) { return a * at(A, i, j) + b * at(B, i, j); });
}

template <class T>
Matrix<T> transpose(const Matrix<T>& A) {
  return filled<T>([&](int i, int j) { return at(A, j, i); });
}

template <class T>
Matrix<T> identity() {
  return filled<T>([](int i, int j) { return T(i == j ? 1.0 : 0.0); });
}

/// The transpose of the inverse, times the determinant.
template <class T>
Matrix<T> cofactors(const Matrix<T>& A) {
  return filled<T>([&](int i, int j) {
    const int k = (i + 1) % 3;
    const int l = (i + 2) % 3;
    const int m = (j + 1) % 3;
    const int n = (j + 2) % 3;
    return at(A, k, m) * at(A, l, n) - at(A, k, n) * at(A, l, m);
  });
}

template <class T>
T determinant(const Matrix<T>& A) {
  const Matrix<T> cof = cofactors(A);
  return A[0][0] * cof[0][0] + A[0][1] * cof[0][1] + A[0][2] * cof[0][2];
}

template <class T>
Matrix<T> inverse(const Matrix<T>& A) {
  return sum(T(1.0) / determinant(A), transpose(cofactors(A)), T(0.0), A);
}

/// A^(1/2) of a symmetric positive definite A, by the iteration of Denman and Beavers. It needs no
/// principal directions, so that equal stretches and derivatives at them are no special case. It
/// converges quadratically; the precision of a Jet, at moderate strain, needs fewer iterations.
template <class T>
Matrix<T> square_root(const Matrix<T>& A) {
  constexpr int kIterations = std::is_same_v<T, Jet> ? 9 : 30;
  Matrix<T> Y = A;
  Matrix<T> Z = identity<T>();
  for (int n = 0; n < kIterations; ++n) {
    const Matrix<T> next = sum(T(0.5), Y, T(0.5), inverse(Z));
    Z = sum(T(0.5), Z, T(0.5), inverse(Y));
    Y = next;
  }
  return Y;
}

/// x^(p/q).
template <class T>
T power(const T& x, double p, double q) {
  using std::exp;
  using std::log;
  return exp(T(p) / T(q) * log(x));
}

template <class T>
Matrix<T> right_cauchy_green(const Matrix<T>& F) {
  return product(transpose(F), F);
}

template <class T>
Matrix<T> isochoric_cauchy_green(const Matrix<T>& F) {
  const Matrix<T> C = right_cauchy_green(F);
  return sum(power(determinant(F), -2.0, 3.0), C, T(0.0), C);
}

template <class T>
T second_invariant(const Matrix<T>& C) {
  return T(0.5) * (trace(C) * trace(C) - trace(product(C, C)));
}

template <class T>
T textbook_energy(const fem::NeoHookean& law, const Matrix<T>& F) {
  using std::log;
  const T log_J = log(determinant(F));
  return T(0.5 * law.mu_mpa) * (trace(right_cauchy_green(F)) - T(3.0) - T(2.0) * log_J) +
         T(0.5 * law.lambda_mpa) * log_J * log_J;
}

/// Hooke's energy of a given strain.
template <class T>
T hooke(double mu, double lambda, const Matrix<T>& strain) {
  return T(mu) * trace(product(strain, strain)) + T(0.5 * lambda) * trace(strain) * trace(strain);
}

template <class T>
T textbook_energy(const fem::LinearElastic& law, const Matrix<T>& F) {
  const Matrix<T> symmetric = sum(T(0.5), F, T(0.5), transpose(F));
  return hooke(law.mu_mpa, law.lambda_mpa, sum(T(1.0), symmetric, T(-1.0), identity<T>()));
}

template <class T>
T textbook_energy(const fem::StVenantKirchhoff& law, const Matrix<T>& F) {
  return hooke(law.mu_mpa, law.lambda_mpa,
               sum(T(0.5), right_cauchy_green(F), T(-0.5), identity<T>()));
}

template <class T>
T textbook_energy(const fem::IsochoricNeoHookean& law, const Matrix<T>& F) {
  return T(0.5 * law.mu_mpa) * (trace(isochoric_cauchy_green(F)) - T(3.0));
}

template <class T>
T textbook_energy(const fem::MooneyRivlin& law, const Matrix<T>& F) {
  const Matrix<T> C = isochoric_cauchy_green(F);
  return T(law.c10_mpa) * (trace(C) - T(3.0)) + T(law.c01_mpa) * (second_invariant(C) - T(3.0));
}

template <class T>
T textbook_energy(const fem::Yeoh& law, const Matrix<T>& F) {
  const T x = trace(isochoric_cauchy_green(F)) - T(3.0);
  return T(law.c10_mpa) * x + T(law.c20_mpa) * x * x + T(law.c30_mpa) * x * x * x;
}

/// tr A^(n/8), given A^(1/8).
template <class T>
T trace_of_power(const Matrix<T>& eighth_root, int n) {
  const Matrix<T> base = n < 0 ? inverse(eighth_root) : eighth_root;
  Matrix<T> result = base;
  for (int k = 1; k < std::abs(n); ++k) result = product(result, base);
  return trace(result);
}

/// The sum of l_i^alpha is tr C^(alpha/2), which needs no principal stretches; alpha is a multiple
/// of
/// 1/4.
template <class T>
T textbook_energy(const fem::Ogden& law, const Matrix<T>& F) {
  const Matrix<T> root = square_root(square_root(square_root(isochoric_cauchy_green(F))));
  T energy(0.0);
  for (const fem::OgdenTerm& term : law.terms) {
    if (term.mu_mpa == 0.0) continue;
    const T powers = trace_of_power(root, int(std::lround(4.0 * term.alpha)));
    energy = energy + T(term.mu_mpa) / T(term.alpha) * (powers - T(3.0));
  }
  return energy;
}

/// a . M b.
template <class T>
T form(const Matrix<T>& M, const Vec3& a, const Vec3& b) {
  T value(0.0);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) value = value + T(a[i]) * at(M, i, j) * T(b[j]);
  return value;
}

template <class T>
T textbook_energy(const fem::FungOrthotropic& law, const Matrix<T>& F) {
  using std::exp;
  const Matrix<T> E = sum(T(0.5), isochoric_cauchy_green(F), T(-0.5), identity<T>());
  const Matrix<T> E2 = product(E, E);
  T cQ(0.0);
  for (int a = 0; a < 3; ++a) {
    cQ = cQ + T(2.0 * law.mu_mpa[a]) * form(E2, law.axes.col(a), law.axes.col(a));
    for (int b = 0; b < 3; ++b)
      cQ = cQ + T(law.lambda_mpa(a, b)) * form(E, law.axes.col(a), law.axes.col(a)) *
                    form(E, law.axes.col(b), law.axes.col(b));
  }
  return T(0.5 * law.c_mpa) * (exp(cQ / T(law.c_mpa)) - T(1.0));
}

/// <= 0 where the family is slack.
template <class T>
T textbook_fiber_strain(const fem::HolzapfelGasserOgden& law, int family, const Matrix<T>& F) {
  const Matrix<T> C = isochoric_cauchy_green(F);
  const Vec3& a = law.fiber[std::size_t(family)];
  // Divided by a . a, which is 1 except for rounding.
  const T I4 = form(C, a, a) / form(identity<T>(), a, a);
  return T(law.dispersion) * (trace(C) - T(3.0)) +
         (T(1.0) - T(3.0) * T(law.dispersion)) * (I4 - T(1.0));
}

template <class T>
T textbook_energy(const fem::HolzapfelGasserOgden& law, const Matrix<T>& F) {
  using std::exp;
  T energy = T(0.5 * law.mu_mpa) * (trace(isochoric_cauchy_green(F)) - T(3.0));
  for (int n = 0; n < law.family_count; ++n) {
    const T e = textbook_fiber_strain(law, n, F);
    if (e > T(0.0))
      energy = energy + T(law.k1_mpa) / T(2.0 * law.k2) * (exp(T(law.k2) * e * e) - T(1.0));
  }
  return energy;
}

template <class T>
T textbook_energy(const fem::Volumetric& volume, const T& J) {
  using std::log;
  switch (volume.form) {
    case fem::VolumetricForm::kQuadratic:
      return T(0.5 * volume.kappa_mpa) * (J - T(1.0)) * (J - T(1.0));
    case fem::VolumetricForm::kQuadraticLog:
      return T(0.25 * volume.kappa_mpa) * (J * J - T(1.0) - T(2.0) * log(J));
    case fem::VolumetricForm::kLogSquared:
      break;
  }
  return T(0.5 * volume.kappa_mpa) * log(J) * log(J);
}

template <class Shear, class T>
T textbook_energy(const fem::DecoupledLaw<Shear>& law, const Matrix<T>& F) {
  return textbook_energy(law.isochoric, F) + textbook_energy(law.volume, determinant(F));
}

}  // namespace lefort::test
