#include <lefort/core/check.h>
#include <lefort/fem/materials/constants.h>
#include <lefort/fem/materials/neo_hookean.h>

#include <fmt/format.h>

#include <cmath>

namespace lefort::fem {

Result<NeoHookean> NeoHookean::from_young_poisson(double young_mpa, double poisson) {
  if (!(poisson >= 0.0))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("neo-hookean: poisson's ratio is {}, must be in [0, 0.5)", poisson));
  LEFORT_TRY(const LameConstants lame,
             LameConstants::from_young_poisson("neo-hookean", young_mpa, poisson));
  return NeoHookean{.mu_mpa = lame.mu_mpa, .lambda_mpa = lame.lambda_mpa};
}

Result<void> NeoHookean::validate() const {
  LEFORT_TRY_VOID(check_positive("neo-hookean", "mu", mu_mpa));
  return check_not_negative("neo-hookean", "lambda", lambda_mpa);
}

double NeoHookean::energy(const Mat3& F) const {
  // I1 - 3 and J - 1 are computed from H = F - I without cancellation, so that the energy is
  // accurate at small strain.
  const Mat3 H = F - Mat3::Identity();
  const double log_J = std::log1p(jacobian_minus_one(F));
  const double I1_minus_3 = 2.0 * H.trace() + H.squaredNorm();
  return 0.5 * mu_mpa * (I1_minus_3 - 2.0 * log_J) + 0.5 * lambda_mpa * log_J * log_J;
}

Mat3 NeoHookean::stress(const Mat3& F) const {
  const double J = volume_ratio(F);
  LEFORT_ASSERT(J > 0.0);
  const Mat3 F_inv_T = F.inverse().transpose();
  // P = F S, S = mu (I - C^-1) + lambda ln J C^-1.
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
  add_transposed_product(from_inverse, F_inv_T, A);
  A.diagonal().array() += mu_mpa;
  return A;
}

}  // namespace lefort::fem
