/// \file
/// Frictionless contact as a potential of the penetration increase d (\cite lefort-paper). With
/// d = g_0 - g(x), g the gap and g_0 the rest gap:
///
///   phi(d) = k_c d^2 for d > 0, else 0            energy per area of the reference surface
///   t      = -dphi/dx = 2 k_c d grad g            traction on the tissue, outward from the bone
///
/// The pure penalty leaves residual penetration. The augmented Lagrangian has a multiplier
/// lambda >= 0, the contact pressure at d = 0 (\cite wriggers2006):
///
///   p(d)      = lambda + 2 k_c d                     pressure; no contact if not positive
///   phi(d)    = (max(p, 0)^2 - lambda^2) / (4 k_c)   dphi/dd = max(p, 0)
///   d2phi/dx2 = 2 k_c grad g (x) grad g - p Hess g   where p > 0, else 0
///
/// With lambda = 0 this is the pure penalty. The term with Hess g is needed for quadratic
/// convergence on curved bone. On convex bone it is negative semidefinite: the tissue tends to
/// slide off. psd_projected_hessian() omits its negative part.
#pragma once

#include <lefort/core/types.h>

namespace lefort::contact {

/// phi and its derivatives by the position of the point, in the frame of the derivatives of the
/// gap.
struct PenaltyResponse {
  double energy_mj_per_mm2 = 0.0;
  Vec3 gradient_mpa = Vec3::Zero();  ///< Minus the traction on the tissue.
  Mat3 hessian_mpa_per_mm = Mat3::Zero();
};

/// Parameters of the potential at one point.
struct PenaltyParameters {
  double stiffness_mpa_per_mm = 0.0;  ///< k_c > 0.
  double multiplier_mpa = 0.0;        ///< lambda >= 0.
};

/// \param depth_mm  d.
/// \returns p(d) [MPa]; 0 without contact, or if d is NaN.
[[nodiscard]] inline double pressure_mpa(double depth_mm, const PenaltyParameters& penalty) {
  const double p = penalty.multiplier_mpa + 2.0 * penalty.stiffness_mpa_per_mm * depth_mm;
  return p > 0.0 ? p : 0.0;
}

/// \param depth_mm  d.
/// \param gradient  of the gap g; that of d is its negative.
/// \param hessian   of the gap g [1/mm].
/// \param penalty   k_c and lambda of the point.
/// \returns phi and its derivatives.
[[nodiscard]] inline PenaltyResponse penalty_response(double depth_mm, const Vec3& gradient,
                                                      const Mat3& hessian,
                                                      const PenaltyParameters& penalty) {
  const double p = pressure_mpa(depth_mm, penalty);
  const double k = penalty.stiffness_mpa_per_mm;
  const double lambda = penalty.multiplier_mpa;
  PenaltyResponse response;
  response.energy_mj_per_mm2 = (p - lambda) * (p + lambda) / (4.0 * k);
  if (!(p > 0.0)) return response;
  response.gradient_mpa = -p * gradient;
  response.hessian_mpa_per_mm = 2.0 * k * gradient * gradient.transpose() - p * hessian;
  return response;
}

/// Positive semidefinite approximation of PenaltyResponse::hessian_mpa_per_mm. Parameters as above;
/// zero where p is not positive.
/// \returns 2 k_c grad g (x) grad g + (-p Hess g)+, where ( )+ is the nearest positive semidefinite
///   matrix.
[[nodiscard]] Mat3 psd_projected_hessian(double depth_mm, const Vec3& gradient, const Mat3& hessian,
                                         const PenaltyParameters& penalty);

}  // namespace lefort::contact
