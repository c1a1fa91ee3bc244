/// \file
/// Frictionless contact as a potential of the depth d (\cite lefort-paper, section 2.3).
///
///   phi(d) = k_c d^2 for d > 0, else 0      (2)   energy per area of the surface at rest
///   f      = -d phi / d x = 2 k_c d n             traction on the tissue, out of the bone
///
/// With d = -g(x), g the gap:  d2 phi / dx2 = 2 k_c (grad g (x) grad g - d Hess g). The second
/// part is what keeps Newton quadratic on curved bone. Where the bone bulges it is negative, as
/// tissue pressed on a bulge wants to slide off: convex_hessian() leaves that out.
#pragma once

#include <lefort/core/types.h>

namespace lefort::contact {

/// phi and its derivatives by the point's position, in the frame of the gap's derivatives.
struct PenaltyResponse {
  double energy_mj_per_mm2 = 0.0;
  Vec3 gradient_mpa = Vec3::Zero();  ///< Minus the traction on the tissue.
  Mat3 hessian_mpa_per_mm = Mat3::Zero();
};

/// \param depth_mm   d; no contact if not positive.
/// \param gradient   of the gap g, so minus that of d.
/// \param hessian    of the gap g [1/mm].
/// \param stiffness_mpa_per_mm  k_c > 0.
[[nodiscard]] inline PenaltyResponse penalty_response(double depth_mm, const Vec3& gradient,
                                                      const Mat3& hessian,
                                                      double stiffness_mpa_per_mm) {
  if (!(depth_mm > 0.0)) return {};
  const double slope_mpa = 2.0 * stiffness_mpa_per_mm * depth_mm;
  return {stiffness_mpa_per_mm * depth_mm * depth_mm, -slope_mpa * gradient,
          2.0 * stiffness_mpa_per_mm * gradient * gradient.transpose() - slope_mpa * hessian};
}

/// A positive semidefinite stand-in for PenaltyResponse::hessian_mpa_per_mm: 2 k_c (grad g (x) grad
/// g + (-d Hess g)+), ( )+ being the nearest positive semidefinite matrix. Parameters as above.
[[nodiscard]] Mat3 convex_hessian(double depth_mm, const Vec3& gradient, const Mat3& hessian,
                                  double stiffness_mpa_per_mm);

}  // namespace lefort::contact
