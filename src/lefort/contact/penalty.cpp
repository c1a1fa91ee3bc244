#include <lefort/contact/penalty.h>

#include <Eigen/Eigenvalues>

namespace lefort::contact {

Mat3 convex_hessian(double depth_mm, const Vec3& gradient, const Mat3& hessian,
                    double stiffness_mpa_per_mm) {
  if (!(depth_mm > 0.0)) return Mat3::Zero();
  const Mat3 curved = -depth_mm * hessian;
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(curved);
  const Vec3 kept = eigen.eigenvalues().cwiseMax(0.0);
  const Mat3& axes = eigen.eigenvectors();
  return 2.0 * stiffness_mpa_per_mm *
         (gradient * gradient.transpose() + axes * kept.asDiagonal() * axes.transpose());
}

}  // namespace lefort::contact
