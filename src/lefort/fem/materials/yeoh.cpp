#include <lefort/fem/materials/constants.h>
#include <lefort/fem/materials/isochoric.h>
#include <lefort/fem/materials/yeoh.h>

#include <fmt/format.h>

#include <cmath>

namespace lefort::fem {

Result<void> Yeoh::validate() const {
  LEFORT_TRY_VOID(check_positive("yeoh", "c10", c10_mpa));
  LEFORT_TRY_VOID(check_not_negative("yeoh", "c30", c30_mpa));
  // The minimum of dPsi/dx is at x = -c20 / (3 c30), if c20 < 0.
  const double minimum = -std::sqrt(3.0 * c10_mpa * c30_mpa);
  if (!(c20_mpa >= 0.0 || c20_mpa > minimum) || !std::isfinite(c20_mpa))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("yeoh: c20 is {} MPa, must be >= 0 or > -sqrt(3 c10 c30) = {} MPa, or "
                            "the law would soften when stretched",
                            c20_mpa, minimum));
  return {};
}

double Yeoh::energy(const Mat3& F) const {
  const double x = IsochoricStrain(F).I1_minus_3;
  return x * (c10_mpa + x * (c20_mpa + x * c30_mpa));
}

Mat3 Yeoh::stress(const Mat3& F) const {
  const IsochoricPart part(F);
  const double x = first_invariant(part.F_iso) - 3.0;
  const double slope = c10_mpa + x * (2.0 * c20_mpa + x * 3.0 * c30_mpa);
  return isochoric_stress(part, 2.0 * slope * part.F_iso);  // dx = 2 F_iso : dF_iso.
}

Mat9 Yeoh::tangent(const Mat3& F) const {
  const IsochoricPart part(F);
  const double x = first_invariant(part.F_iso) - 3.0;
  const double slope = c10_mpa + x * (2.0 * c20_mpa + x * 3.0 * c30_mpa);
  const double curvature = 2.0 * c20_mpa + x * 6.0 * c30_mpa;
  const Vec9 f = flatten(part.F_iso);
  Mat9 A = 4.0 * curvature * f * f.transpose();
  A.diagonal().array() += 2.0 * slope;
  return isochoric_tangent(part, 2.0 * slope * part.F_iso, A);
}

}  // namespace lefort::fem
