#include <lefort/fem/materials/constants.h>
#include <lefort/fem/materials/holzapfel_gasser_ogden.h>
#include <lefort/fem/materials/isochoric.h>

#include <fmt/format.h>

#include <cmath>

namespace lefort::fem {
namespace {

constexpr const char* kHgoName = "holzapfel-gasser-ogden";

/// \returns e of one family; <= 0 if it is slack.
double fiber_strain(const HolzapfelGasserOgden& law, const IsochoricStrain& strain,
                    const Vec3& fiber) {
  const double I4_minus_1 = fiber.dot(strain.twice_strain() * fiber);
  return law.dispersion * strain.I1_minus_3 + (1.0 - 3.0 * law.dispersion) * I4_minus_1;
}

/// \returns 1/2 de/df with f = F_iso.
Mat3 half_slope_of_strain(const HolzapfelGasserOgden& law, const Mat3& f, const Vec3& fiber) {
  return law.dispersion * f + (1.0 - 3.0 * law.dispersion) * (f * fiber) * fiber.transpose();
}

}  // namespace

Result<void> HolzapfelGasserOgden::validate() const {
  LEFORT_TRY_VOID(check_positive(kHgoName, "mu", mu_mpa));
  LEFORT_TRY_VOID(check_not_negative(kHgoName, "k1", k1_mpa));
  if (!(k2 > 0.0) || !std::isfinite(k2))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: k2 is {}, must be > 0", kHgoName, k2));
  if (!(dispersion >= 0.0 && dispersion <= 1.0 / 3.0))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: dispersion is {}, must be in [0, 1/3]", kHgoName, dispersion));
  if (family_count < 1 || family_count > 2)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: family_count is {}, must be 1 or 2", kHgoName, family_count));
  for (int n = 0; n < family_count; ++n)
    LEFORT_TRY_VOID(check_unit(kHgoName, fmt::format("fiber {}", n + 1), fiber[std::size_t(n)]));
  return {};
}

double HolzapfelGasserOgden::energy(const Mat3& F) const {
  const IsochoricStrain strain(F);
  double sum = 0.5 * mu_mpa * strain.I1_minus_3;
  for (int n = 0; n < family_count; ++n) {
    const double e = fiber_strain(*this, strain, fiber[std::size_t(n)]);
    if (e > 0.0) sum += 0.5 * k1_mpa / k2 * std::expm1(k2 * e * e);
  }
  return sum;
}

Mat3 HolzapfelGasserOgden::stress(const Mat3& F) const {
  const IsochoricPart part(F);
  const IsochoricStrain strain(F);
  Mat3 P_iso = mu_mpa * part.F_iso;
  for (int n = 0; n < family_count; ++n) {
    const Vec3& a = fiber[std::size_t(n)];
    const double e = fiber_strain(*this, strain, a);
    if (e > 0.0)
      P_iso += 2.0 * k1_mpa * e * std::exp(k2 * e * e) * half_slope_of_strain(*this, part.F_iso, a);
  }
  return isochoric_stress(part, P_iso);
}

Mat9 HolzapfelGasserOgden::tangent(const Mat3& F) const {
  const IsochoricPart part(F);
  const IsochoricStrain strain(F);
  Mat3 P_iso = mu_mpa * part.F_iso;
  Mat9 A = mu_mpa * Mat9::Identity();
  for (int n = 0; n < family_count; ++n) {
    const Vec3& a = fiber[std::size_t(n)];
    const double e = fiber_strain(*this, strain, a);
    if (!(e > 0.0)) continue;
    const double stiffness = k1_mpa * std::exp(k2 * e * e);
    const Mat3 h = half_slope_of_strain(*this, part.F_iso, a);
    P_iso += 2.0 * stiffness * e * h;
    const Vec9 v = flatten(h);
    A.noalias() += (4.0 * stiffness * (1.0 + 2.0 * k2 * e * e)) * v * v.transpose();
    A.diagonal().array() += 2.0 * stiffness * e * dispersion;
    add_right_product(2.0 * stiffness * e * (1.0 - 3.0 * dispersion) * a * a.transpose(), A);
  }
  return isochoric_tangent(part, P_iso, A);
}

}  // namespace lefort::fem
