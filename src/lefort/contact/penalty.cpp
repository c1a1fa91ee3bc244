#include <lefort/contact/penalty.h>
#include <lefort/core/decompositions.h>

namespace lefort::contact {

Mat3 psd_projected_hessian(double depth_mm, const Vec3& gradient, const Mat3& hessian,
                           const PenaltyParameters& penalty) {
  const double p = pressure_mpa(depth_mm, penalty);
  if (!(p > 0.0)) return Mat3::Zero();
  const SymmetricEigen<3> eigen = symmetric_eigen(Mat3(-p * hessian));
  const Vec3 projected = eigen.values.cwiseMax(0.0);
  const Mat3& axes = eigen.vectors;
  return 2.0 * penalty.stiffness_mpa_per_mm * gradient * gradient.transpose() +
         axes * projected.asDiagonal() * axes.transpose();
}

}  // namespace lefort::contact
