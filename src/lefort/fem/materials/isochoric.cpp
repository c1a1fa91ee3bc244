#include <lefort/core/check.h>
#include <lefort/fem/materials/isochoric.h>

#include <cmath>

namespace lefort::fem {

IsochoricPart::IsochoricPart(const Mat3& F) {
  const double J = volume_ratio(F);
  LEFORT_ASSERT(J > 0.0);
  scale = 1.0 / std::cbrt(J);
  F_iso = scale * F;
  F_inv_T = cofactor(F) / J;
}

// With g = F^-T: dF_iso = scale (dF - (g : dF) F / 3), from which both functions below follow.

Mat3 isochoric_stress(const IsochoricPart& part, const Mat3& dpsi) {
  const double third = contract(dpsi, part.F_iso) / 3.0;
  const Mat3 P = part.scale * dpsi - third * part.F_inv_T;
  // P : F must vanish. The second projection removes the round-off; at F = I P is exactly zero.
  const double rest = contract(P, part.F_iso) / (3.0 * part.scale);
  return P - rest * part.F_inv_T;
}

Mat9 isochoric_tangent(const IsochoricPart& part, const Mat3& dpsi, const Mat9& ddpsi) {
  const Vec9 f = flatten(part.F_iso);
  const Vec9 g = flatten(part.F_inv_T);
  const double third = contract(dpsi, part.F_iso) / 3.0;

  // Derivative of dpsi: M^T ddpsi M, where dF_iso = M : dF and M = scale I - f g^T / 3.
  const Vec9 Af = ddpsi * f / 3.0;
  const double ff = f.dot(Af) / 3.0;
  // Derivative of M, and the two terms with one factor g: u g^T + g u^T.
  const Vec9 u = (0.5 * (ff + third / 3.0)) * g - part.scale * (Af + flatten(dpsi) / 3.0);
  Mat9 A = (part.scale * part.scale) * ddpsi;
  A += u * g.transpose() + g * u.transpose();
  add_transposed_product(third, part.F_inv_T, A);
  return A;
}

IsochoricStrain::IsochoricStrain(const Mat3& F) {
  const Mat3 H = F - Mat3::Identity();
  const Mat3 twice_E = H + H.transpose() + H.transpose() * H;  // C - I.
  const double third = twice_E.trace() / 3.0;
  const double mean = 1.0 + third;  // tr C / 3.
  D = (twice_E - third * Mat3::Identity()) / mean;

  // det(I + D) = 1 - q + d = J^2 / mean^3; the second invariant of I + D is 3 - q.
  const double q = 0.5 * D.squaredNorm();
  const double d = D.determinant();
  // The difference is accurate at moderate strain, the logarithms at large strain.
  const double log_det =
      d - q > -0.5 ? std::log1p(d - q) : 2.0 * std::log(volume_ratio(F)) - 3.0 * std::log1p(third);
  I1_minus_3 = 3.0 * std::expm1(-log_det / 3.0);
  I2_minus_3 = 3.0 * std::expm1(-2.0 / 3.0 * log_det) - q * std::exp(-2.0 / 3.0 * log_det);
}

}  // namespace lefort::fem
