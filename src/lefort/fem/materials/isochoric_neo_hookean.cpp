#include <lefort/fem/materials/constants.h>
#include <lefort/fem/materials/isochoric.h>
#include <lefort/fem/materials/isochoric_neo_hookean.h>

namespace lefort::fem {

Result<void> IsochoricNeoHookean::validate() const {
  return check_positive("isochoric neo-hookean", "mu", mu_mpa);
}

double IsochoricNeoHookean::energy(const Mat3& F) const {
  return 0.5 * mu_mpa * IsochoricStrain(F).I1_minus_3;
}

Mat3 IsochoricNeoHookean::stress(const Mat3& F) const {
  const IsochoricPart part(F);
  return isochoric_stress(part, mu_mpa * part.F_iso);
}

Mat9 IsochoricNeoHookean::tangent(const Mat3& F) const {
  const IsochoricPart part(F);
  return isochoric_tangent(part, mu_mpa * part.F_iso, mu_mpa * Mat9::Identity());
}

}  // namespace lefort::fem
