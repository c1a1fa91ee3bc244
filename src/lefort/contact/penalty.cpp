#include <lefort/contact/penalty.h>
#include <lefort/core/decompositions.h>

namespace lefort::contact {

PenaltyResponse penalty_response(double depth_mm, const Vec3& gradient, const Mat3& hessian,
                                 const PressureLaw& law) {
  PenaltyResponse response;
  const double p = pressure_mpa(depth_mm, law);
  if (!(p > 0.0)) return response;
  // The integral of q: c d^3 / 3, and c d_1 (d_1^2 / 3 + d (d - d_1)) beyond d_1.
  const double d_1 = std::min(depth_mm, law.linear_beyond_mm);
  response.energy_mj_per_mm2 =
      law.penalty_mpa_per_mm * depth_mm * depth_mm +
      law.hardening_mpa_per_mm2 * d_1 * (d_1 * d_1 / 3.0 + depth_mm * (depth_mm - d_1));
  response.gradient_mpa = -p * gradient;
  response.hessian_mpa_per_mm =
      pressure_slope_mpa_per_mm(depth_mm, law) * gradient * gradient.transpose() - p * hessian;
  return response;
}

Mat3 psd_projected_hessian(double depth_mm, const Vec3& gradient, const Mat3& hessian,
                           const PressureLaw& law) {
  const double p = pressure_mpa(depth_mm, law);
  if (!(p > 0.0)) return Mat3::Zero();
  const SymmetricEigen<3> eigen = symmetric_eigen(Mat3(-p * hessian));
  const Vec3 projected = eigen.values.cwiseMax(0.0);
  const Mat3& axes = eigen.vectors;
  return pressure_slope_mpa_per_mm(depth_mm, law) * gradient * gradient.transpose() +
         axes * projected.asDiagonal() * axes.transpose();
}

}  // namespace lefort::contact
