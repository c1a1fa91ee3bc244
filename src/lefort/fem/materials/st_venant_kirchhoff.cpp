#include <lefort/fem/materials/constants.h>
#include <lefort/fem/materials/st_venant_kirchhoff.h>

namespace lefort::fem {
namespace {

/// \returns E = (C - I) / 2, from H = F - I: accurate at small strain.
Mat3 green_strain(const Mat3& F) {
  const Mat3 H = F - Mat3::Identity();
  return 0.5 * (H + H.transpose() + H.transpose() * H);
}

/// \returns the second Piola-Kirchhoff stress.
Mat3 second_stress(const StVenantKirchhoff& law, const Mat3& E) {
  return 2.0 * law.mu_mpa * E + law.lambda_mpa * E.trace() * Mat3::Identity();
}

}  // namespace

Result<StVenantKirchhoff> StVenantKirchhoff::from_young_poisson(double young_mpa, double poisson) {
  LEFORT_TRY(const LameConstants lame,
             LameConstants::from_young_poisson("st venant-kirchhoff", young_mpa, poisson));
  return StVenantKirchhoff{.mu_mpa = lame.mu_mpa, .lambda_mpa = lame.lambda_mpa};
}

Result<void> StVenantKirchhoff::validate() const {
  return LameConstants{mu_mpa, lambda_mpa}.validate("st venant-kirchhoff");
}

double StVenantKirchhoff::energy(const Mat3& F) const {
  const Mat3 E = green_strain(F);
  const double trace = E.trace();
  return mu_mpa * E.squaredNorm() + 0.5 * lambda_mpa * trace * trace;
}

Mat3 StVenantKirchhoff::stress(const Mat3& F) const {
  return F * second_stress(*this, green_strain(F));
}

Mat9 StVenantKirchhoff::tangent(const Mat3& F) const {
  // dP = dF S + F dS, dS = 2 mu dE + lambda tr(dE) I, 2 dE = dF^T F + F^T dF.
  const Vec9 f = flatten(F);
  Mat9 A = lambda_mpa * f * f.transpose();
  add_right_product(second_stress(*this, green_strain(F)), A);
  add_left_product(mu_mpa * F * F.transpose(), A);
  add_transposed_product(mu_mpa, F, A);
  return A;
}

}  // namespace lefort::fem
