#include <lefort/core/check.h>
#include <lefort/fem/materials/neo_hookean.h>

#include <fmt/format.h>

#include <cmath>

namespace lefort::fem {

Result<NeoHookean> NeoHookean::from_young_poisson(double young_mpa, double poisson) {
  if (!(young_mpa > 0.0) || !std::isfinite(young_mpa))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("neo-hookean: young's modulus is {} MPa, must be > 0", young_mpa));
  if (!(poisson >= 0.0 && poisson < 0.5))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("neo-hookean: poisson's ratio is {}, must be in [0, 0.5)", poisson));
  return NeoHookean{.mu_mpa = young_mpa / (2.0 * (1.0 + poisson)),
                    .lambda_mpa = young_mpa * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson))};
}

Result<void> NeoHookean::validate() const {
  if (!(mu_mpa > 0.0) || !std::isfinite(mu_mpa))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("neo-hookean: mu is {} MPa, must be > 0", mu_mpa));
  if (!(lambda_mpa >= 0.0) || !std::isfinite(lambda_mpa))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("neo-hookean: lambda is {} MPa, must be >= 0", lambda_mpa));
  return {};
}

double NeoHookean::energy(const Mat3& F) const {
  // With H = F - I, I1 - 3 and J - 1 are formed without subtracting nearly equal numbers, so that
  // energies of small strains keep their digits.
  const Mat3 H = F - Mat3::Identity();
  const double log_J = std::log1p(volume_change(F));
  const double I1_minus_3 = 2.0 * H.trace() + H.squaredNorm();
  return 0.5 * mu_mpa * (I1_minus_3 - 2.0 * log_J) + 0.5 * lambda_mpa * log_J * log_J;
}

Mat3 NeoHookean::stress(const Mat3& F) const {
  const double J = volume_ratio(F);
  LEFORT_ASSERT(J > 0.0);
  const Mat3 F_inv_T = F.inverse().transpose();
  // P = F S with S of eq. 6.28.
  return mu_mpa * (F - F_inv_T) + lambda_mpa * std::log(J) * F_inv_T;
}

Mat9 NeoHookean::tangent(const Mat3& F) const {
  const double J = volume_ratio(F);
  LEFORT_ASSERT(J > 0.0);
  const Mat3 F_inv_T = F.inverse().transpose();
  const Vec9 g = flatten(F_inv_T);
  // dP = mu dF + (mu - lambda ln J) F^-T dF^T F^-T + lambda (F^-T : dF) F^-T.
  Mat9 A = lambda_mpa * g * g.transpose();
  const double from_inverse = mu_mpa - lambda_mpa * std::log(J);
  add_inverse_tangent(from_inverse, F_inv_T, A);
  A.diagonal().array() += mu_mpa;
  return A;
}

}  // namespace lefort::fem
