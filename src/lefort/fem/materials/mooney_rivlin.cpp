#include <lefort/fem/materials/constants.h>
#include <lefort/fem/materials/isochoric.h>
#include <lefort/fem/materials/mooney_rivlin.h>

namespace lefort::fem {

Result<void> MooneyRivlin::validate() const {
  LEFORT_TRY_VOID(check_not_negative("mooney-rivlin", "c10", c10_mpa));
  LEFORT_TRY_VOID(check_not_negative("mooney-rivlin", "c01", c01_mpa));
  return check_positive("mooney-rivlin", "c10 + c01", c10_mpa + c01_mpa);
}

double MooneyRivlin::energy(const Mat3& F) const {
  const IsochoricStrain strain(F);
  return c10_mpa * strain.I1_minus_3 + c01_mpa * strain.I2_minus_3;
}

Mat3 MooneyRivlin::stress(const Mat3& F) const {
  const IsochoricPart part(F);
  const Mat3& f = part.F_iso;
  // dI1 = 2 f : df, dI2 = 2 (I1 f - f C) : df.
  const double I1 = first_invariant(f);
  const Mat3 P_iso = 2.0 * (c10_mpa + c01_mpa * I1) * f - 2.0 * c01_mpa * f * right_cauchy_green(f);
  return isochoric_stress(part, P_iso);
}

Mat9 MooneyRivlin::tangent(const Mat3& F) const {
  const IsochoricPart part(F);
  const Mat3& f = part.F_iso;
  const Mat3 C = right_cauchy_green(f);
  const double factor = 2.0 * (c10_mpa + c01_mpa * C.trace());
  const Mat3 P_iso = factor * f - 2.0 * c01_mpa * f * C;

  const Vec9 v = flatten(f);
  Mat9 A = 4.0 * c01_mpa * v * v.transpose();
  A.diagonal().array() += factor;
  add_left_product(-2.0 * c01_mpa * f * f.transpose(), A);
  add_right_product(-2.0 * c01_mpa * C, A);
  add_transposed_product(-2.0 * c01_mpa, f, A);
  return isochoric_tangent(part, P_iso, A);
}

}  // namespace lefort::fem
