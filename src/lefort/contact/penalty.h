/// \file
/// Frictionless contact as a potential of the penetration increase d. With d = g_0 - g(x), g the
/// gap and g_0 the rest gap:
///
///   p(d)      = 2 k_c d + q(d), d > 0; else 0             pressure
///   phi(d)    = k_c d^2 + int q                           energy per area of the reference surface
///   t         = -dphi/dx = p grad g                       traction on the tissue, out of the bone
///   d2phi/dx2 = p' grad g (x) grad g - p Hess g
///
/// The term with k_c is the penalty of \cite lefort-paper. The hardening term is the normal
/// compliance of \cite oden1985 with the exponent 2, continued linearly beyond the depth d_1:
///
///   q(d) = c d^2                  d <= d_1
///   q(d) = c d_1 (2 d - d_1)      d > d_1
///
/// It makes contact soft where a point begins to touch, so that Newton's method finds the contact
/// area in few iterations, and stiff where the pressure is high. From a depth far beyond d_1, one
/// step of Newton's method would halve the depth under c d^2; under the linear continuation it
/// leads to about d_1 / 2.
///
/// The term with Hess g is needed for quadratic convergence on curved bone. On convex bone it is
/// negative semidefinite: the tissue tends to slide off. psd_projected_hessian() omits its negative
/// part.
#pragma once

#include <lefort/core/types.h>

#include <algorithm>

namespace lefort::contact {

/// Coefficients of p(d); none negative, one of the first two > 0.
struct PressureLaw {
  double penalty_mpa_per_mm = 0.0;     ///< k_c.
  double hardening_mpa_per_mm2 = 0.0;  ///< c.
  double linear_beyond_mm = 0.0;       ///< d_1 > 0 if c > 0.
};

/// \param penalty_mpa_per_mm  k_c >= 0.
/// \param young_mpa           E of the tissue, > 0.
/// \param tolerance_mm        depth t > 0 at which the hardening term is 4 E. Such a nominal stress
///   compresses incompressible neo-Hookean tissue with free sides to less than a third of its
///   height.
/// \returns the law with c = 4 E / t^2 and d_1 = 2 t.
[[nodiscard]] constexpr PressureLaw hardening_law(double penalty_mpa_per_mm, double young_mpa,
                                                  double tolerance_mm) {
  return {penalty_mpa_per_mm, 4.0 * young_mpa / (tolerance_mm * tolerance_mm), 2.0 * tolerance_mm};
}

/// phi and its derivatives by the position of the point, in the frame of the derivatives of the
/// gap.
struct PenaltyResponse {
  double energy_mj_per_mm2 = 0.0;
  Vec3 gradient_mpa = Vec3::Zero();  ///< Minus the traction on the tissue.
  Mat3 hessian_mpa_per_mm = Mat3::Zero();
};

/// \param depth_mm  d.
/// \returns p(d) [MPa]; 0 without contact, or if d is NaN.
[[nodiscard]] inline double pressure_mpa(double depth_mm, const PressureLaw& law) {
  if (!(depth_mm > 0.0)) return 0.0;
  const double d_1 = std::min(depth_mm, law.linear_beyond_mm);
  return 2.0 * law.penalty_mpa_per_mm * depth_mm +
         law.hardening_mpa_per_mm2 * d_1 * (2.0 * depth_mm - d_1);
}

/// \param depth_mm  d > 0.
/// \returns dp/dd [MPa/mm].
[[nodiscard]] inline double pressure_slope_mpa_per_mm(double depth_mm, const PressureLaw& law) {
  return 2.0 * (law.penalty_mpa_per_mm +
                law.hardening_mpa_per_mm2 * std::min(depth_mm, law.linear_beyond_mm));
}

/// \param depth_mm  d.
/// \param gradient  of the gap g; that of d is its negative.
/// \param hessian   of the gap g [1/mm].
/// \returns phi and its derivatives; zero where d is not positive.
[[nodiscard]] PenaltyResponse penalty_response(double depth_mm, const Vec3& gradient,
                                               const Mat3& hessian, const PressureLaw& law);

/// Positive semidefinite approximation of PenaltyResponse::hessian_mpa_per_mm. Parameters as above;
/// zero where d is not positive.
/// \returns p' grad g (x) grad g + (-p Hess g)+, where ( )+ is the nearest positive semidefinite
///   matrix.
[[nodiscard]] Mat3 psd_projected_hessian(double depth_mm, const Vec3& gradient, const Mat3& hessian,
                                         const PressureLaw& law);

}  // namespace lefort::contact
