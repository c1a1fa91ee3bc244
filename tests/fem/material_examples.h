/// \file
/// One example of every law with its known properties, for the tests of all laws.
#pragma once

#include <lefort/fem/materials/material.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <variant>

#include "fem/random_deformation.h"

namespace lefort::test {

/// For each law: law(), an example whose constants all differ; small_strain_energy(law, eps), to
/// second order in the symmetric eps; symmetry(law, random), a rotation of the reference
/// configuration that does not change the energy.
template <class Law>
struct Example;

inline Mat3 deviator(const Mat3& eps) { return eps - eps.trace() / 3.0 * Mat3::Identity(); }

inline double square(double x) { return x * x; }

/// An isotropic law with Lame's constants.
template <class Law>
struct LameExample {
  static Law law() { return {.mu_mpa = 0.7, .lambda_mpa = 2.9}; }
  static double small_strain_energy(const Law& law, const Mat3& eps) {
    return law.mu_mpa * eps.squaredNorm() + 0.5 * law.lambda_mpa * square(eps.trace());
  }
  static Mat3 symmetry(const Law& /*law*/, RandomDeformation& random) { return random.rotation(); }
};

template <>
struct Example<fem::NeoHookean> : LameExample<fem::NeoHookean> {};
template <>
struct Example<fem::LinearElastic> : LameExample<fem::LinearElastic> {};
template <>
struct Example<fem::StVenantKirchhoff> : LameExample<fem::StVenantKirchhoff> {};

/// An isotropic isochoric law.
template <class Law>
struct IsochoricExample {
  static double small_strain_energy(const Law& law, const Mat3& eps) {
    return law.shear_modulus_mpa() * deviator(eps).squaredNorm();
  }
  static Mat3 symmetry(const Law& /*law*/, RandomDeformation& random) { return random.rotation(); }
};

template <>
struct Example<fem::IsochoricNeoHookean> : IsochoricExample<fem::IsochoricNeoHookean> {
  static fem::IsochoricNeoHookean law() { return {.mu_mpa = 0.7}; }
};

template <>
struct Example<fem::MooneyRivlin> : IsochoricExample<fem::MooneyRivlin> {
  static fem::MooneyRivlin law() { return {.c10_mpa = 0.4, .c01_mpa = 0.15}; }
};

template <>
struct Example<fem::Yeoh> : IsochoricExample<fem::Yeoh> {
  static fem::Yeoh law() { return {.c10_mpa = 0.3, .c20_mpa = -0.05, .c30_mpa = 0.02}; }
};

template <>
struct Example<fem::Ogden> : IsochoricExample<fem::Ogden> {
  static fem::Ogden law() { return {.terms = {{{0.5, 1.25}, {0.02, 5.0}, {-0.1, -2.5}}}}; }
};

template <>
struct Example<fem::FungOrthotropic> {
  static fem::FungOrthotropic law() {
    RandomDeformation random(21);
    fem::FungOrthotropic law{.mu_mpa = {1.7, 0.6, 0.8}, .c_mpa = 1.9, .axes = random.rotation()};
    law.lambda_mpa << 0.3, 0.1, -0.2, 0.1, 0.5, 0.15, -0.2, 0.15, 0.2;
    return law;
  }
  static double small_strain_energy(const fem::FungOrthotropic& law, const Mat3& eps) {
    const Mat3 e = law.axes.transpose() * deviator(eps) * law.axes;
    double twice = 0.0;
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b)
        twice += (law.mu_mpa[a] + law.mu_mpa[b]) * square(e(a, b)) +
                 law.lambda_mpa(a, b) * e(a, a) * e(b, b);
    return 0.5 * twice;
  }
  /// Half a turn about an axis.
  static Mat3 symmetry(const fem::FungOrthotropic& law, RandomDeformation& random) {
    const Vec3 axis = law.axes.col(int(1.5 * (random.number() + 1.0)) % 3);
    return 2.0 * axis * axis.transpose() - Mat3::Identity();
  }
};

template <>
struct Example<fem::HolzapfelGasserOgden> {
  static fem::HolzapfelGasserOgden law() {
    return {.mu_mpa = 0.7,
            .k1_mpa = 0.9,
            .k2 = 0.11,
            .dispersion = 0.1,
            .family_count = 2,
            .fiber = {Vec3(2.0, 1.0, -2.0) / 3.0, Vec3(0.6, 0.0, 0.8)}};
  }
  static double small_strain_energy(const fem::HolzapfelGasserOgden& law, const Mat3& eps) {
    const Mat3 e = deviator(eps);
    double energy = law.mu_mpa * e.squaredNorm();
    for (const Vec3& a : law.fiber)
      energy += 0.5 * law.k1_mpa *
                square(std::max(0.0, (1.0 - 3.0 * law.dispersion) * 2.0 * a.dot(e * a)));
    return energy;
  }
  /// Half a turn about the normal of both families, or about their bisector, which swaps them.
  static Mat3 symmetry(const fem::HolzapfelGasserOgden& law, RandomDeformation& random) {
    const Vec3 axis = random.number() < 0.0 ? law.fiber[0].cross(law.fiber[1]).normalized()
                                            : (law.fiber[0] + law.fiber[1]).normalized();
    return 2.0 * axis * axis.transpose() - Mat3::Identity();
  }
};

template <class Shear>
struct Example<fem::DecoupledLaw<Shear>> {
  static fem::DecoupledLaw<Shear> law() {
    return {.isochoric = Example<Shear>::law(),
            .volume = {.form = fem::VolumetricForm::kQuadraticLog, .kappa_mpa = 3.1}};
  }
  static double small_strain_energy(const fem::DecoupledLaw<Shear>& law, const Mat3& eps) {
    return Example<Shear>::small_strain_energy(law.isochoric, eps) +
           0.5 * law.volume.kappa_mpa * square(eps.trace());
  }
  static Mat3 symmetry(const fem::DecoupledLaw<Shear>& law, RandomDeformation& random) {
    return Example<Shear>::symmetry(law.isochoric, random);
  }
};

/// Every isochoric law.
using IsochoricExamples =
    testing::Types<fem::IsochoricNeoHookean, fem::MooneyRivlin, fem::Yeoh, fem::Ogden,
                   fem::FungOrthotropic, fem::HolzapfelGasserOgden>;

/// Every law of the variant Material.
template <class Variant>
struct TypesOf;
template <class... Laws>
struct TypesOf<std::variant<Laws...>> {
  using Types = testing::Types<Laws...>;
};
using AllLaws = TypesOf<fem::Material>::Types;

}  // namespace lefort::test
