#include <lefort/core/check.h>
#include <lefort/verify/reference_laws.h>

#include <cmath>
#include <type_traits>
#include <variant>

namespace lefort::verify {
namespace {

// m_i = l_i dW/dl_i of the isochoric parts.

Vec3 shear_moments(const fem::IsochoricNeoHookean& law, const Vec3& l) {
  return law.mu_mpa * l.array().square();
}

Vec3 shear_moments(const fem::MooneyRivlin& law, const Vec3& l) {
  const Vec3 s = l.array().square();
  return 2.0 * s.array() * (law.c10_mpa + law.c01_mpa * (s.sum() - s.array()));
}

Vec3 shear_moments(const fem::Yeoh& law, const Vec3& l) {
  const Vec3 s = l.array().square();
  const double x = s.sum() - 3.0;
  return 2.0 * (law.c10_mpa + 2.0 * law.c20_mpa * x + 3.0 * law.c30_mpa * x * x) * s;
}

Vec3 shear_moments(const fem::Ogden& law, const Vec3& l) {
  Vec3 m = Vec3::Zero();
  for (const fem::OgdenTerm& term : law.terms)
    if (term.mu_mpa != 0.0) m += term.mu_mpa * Vec3(l.array().pow(term.alpha));
  return m;
}

Vec3 shear_moments(const fem::FungOrthotropic& law, const Vec3& l) {
  const Vec3 E = 0.5 * (l.array().square() - 1.0);
  const Vec3 slope = 2.0 * law.mu_mpa.cwiseProduct(E) + law.lambda_mpa * E;  // d(c Q/2)/dE.
  const double Q = slope.dot(E) / law.c_mpa;
  return std::exp(Q) * slope.array() * l.array().square();
}

Vec3 shear_moments(const fem::HolzapfelGasserOgden& law, const Vec3& l) {
  const Vec3 s = l.array().square();
  Vec3 m = law.mu_mpa * s;
  const double d = law.dispersion;
  const double e = d * (s.sum() - 3.0) + (1.0 - 3.0 * d) * (s[0] - 1.0);
  if (e <= 0.0) return m;
  const Vec3 de_ds = Vec3::Constant(d) + (1.0 - 3.0 * d) * Vec3::UnitX();
  m += 2.0 * law.k1_mpa * e * std::exp(law.k2 * e * e) * de_ds.cwiseProduct(s);
  return m;
}

/// dU/dJ; all examples have this form.
double pressure(const fem::Volumetric& volume, double J) {
  LEFORT_CHECK(volume.form == fem::VolumetricForm::kQuadraticLog);
  return 0.5 * volume.kappa_mpa * (J - 1.0 / J);
}

Vec3 stress_of(const fem::NeoHookean& law, const Vec3& l) {
  return law.mu_mpa * (l - l.cwiseInverse()) +
         law.lambda_mpa * std::log(l.prod()) * l.cwiseInverse();
}

Vec3 stress_of(const fem::LinearElastic& law, const Vec3& l) {
  const Vec3 strain = l - Vec3::Ones();
  return 2.0 * law.mu_mpa * strain + Vec3::Constant(law.lambda_mpa * strain.sum());
}

Vec3 stress_of(const fem::StVenantKirchhoff& law, const Vec3& l) {
  const Vec3 E = 0.5 * (l.array().square() - 1.0);
  return l.cwiseProduct(2.0 * law.mu_mpa * E + Vec3::Constant(law.lambda_mpa * E.sum()));
}

template <class Shear>
Vec3 stress_of(const fem::DecoupledLaw<Shear>& law, const Vec3& l) {
  const double J = l.prod();
  const Vec3 m = shear_moments(law.isochoric, std::pow(J, -1.0 / 3.0) * l);
  return (m.array() - m.mean() + J * pressure(law.volume, J)).matrix().cwiseQuotient(l);
}

/// Simple shear has the principal stretches s, 1/s, 1 with gamma = s - 1/s; the true stress in that
/// frame, rotated back: sigma_xy = (sigma_1 - sigma_2) s / (1 + s^2).
template <class Law>
double isotropic_shear(const Law& law, double gamma) {
  const double s = 0.5 * (gamma + std::sqrt(gamma * gamma + 4.0));
  const Vec3 l(s, 1.0 / s, 1.0);
  const Vec3 sigma = stress_of(law, l).cwiseProduct(l);
  return (sigma[0] - sigma[1]) * s / (1.0 + s * s);
}

template <class Law>
double shear_of(const Law& law, double gamma) {
  return isotropic_shear(law, gamma);
}

double shear_of(const fem::LinearElastic& law, double gamma) { return law.mu_mpa * gamma; }

/// C_xx = 1 + gamma^2, C_xy = gamma: W follows by hand.
double shear_of(const fem::DecoupledLaw<fem::FungOrthotropic>& law, double gamma) {
  const auto& [mu, lambda, c, axes] = law.isochoric;
  const double g2 = gamma * gamma;
  const double cQ = 0.5 * (mu[0] + mu[1]) * g2 + (0.5 * mu[0] + 0.25 * lambda(0, 0)) * g2 * g2;
  const double slope = (mu[0] + mu[1]) * gamma + (2.0 * mu[0] + lambda(0, 0)) * g2 * gamma;
  return 0.5 * std::exp(cQ / c) * slope;
}

double shear_of(const fem::DecoupledLaw<fem::HolzapfelGasserOgden>& law, double gamma) {
  const auto& shear = law.isochoric;
  const double per_square = 1.0 - 2.0 * shear.dispersion;
  const double e = per_square * gamma * gamma;
  return shear.mu_mpa * gamma +
         2.0 * shear.k1_mpa * e * std::exp(shear.k2 * e * e) * per_square * gamma;
}

/// The root of an ascending function between 0.2 and 3, by bisection.
template <class Function>
double root(const Function& f) {
  double low = 0.2;
  double high = 3.0;
  LEFORT_CHECK(f(low) < 0.0 && f(high) > 0.0);
  for (int n = 0; n < 100; ++n) {
    const double middle = 0.5 * (low + high);
    (f(middle) < 0.0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

Vec3 principal_stress(const fem::Material& law, const Vec3& stretches) {
  return std::visit([&](const auto& one) { return stress_of(one, stretches); }, law);
}

double simple_shear_stress(const fem::Material& law, double gamma) {
  return std::visit([&](const auto& one) { return shear_of(one, gamma); }, law);
}

FreeStretch uniaxial(const fem::Material& law, double stretch) {
  const double t = root([&](double one) { return principal_stress(law, {stretch, one, one})[1]; });
  return {principal_stress(law, {stretch, t, t})[0], t};
}

FreeStretch equibiaxial(const fem::Material& law, double stretch) {
  const double t = root([&](double one) {
    return principal_stress(law, {stretch, stretch, one})[2];
  });
  return {principal_stress(law, {stretch, stretch, t})[0], t};
}

double incompressible_uniaxial(const fem::Material& law, double stretch) {
  const Vec3 l(stretch, 1.0 / std::sqrt(stretch), 1.0 / std::sqrt(stretch));
  // J = 1: U' is zero, and the pressure follows from the free sides.
  const Vec3 sigma = principal_stress(law, l).cwiseProduct(l);
  return (sigma[0] - sigma[1]) / stretch;
}

}  // namespace lefort::verify
