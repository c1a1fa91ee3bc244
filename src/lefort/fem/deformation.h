/// \file
/// The kinematics all laws share. Symbols and equation numbers: \cite bonet2008.
///
/// X is a reference and x a current position. F maps dX to dx (eq. 4.7) and is unitless.
#pragma once

#include <lefort/core/types.h>

namespace lefort::fem {

/// A linear map between 3x3 matrices, acting on their columns stacked: entry (i, J) is number
/// i + 3 J. So dP = A : dF reads flatten(dP) = A * flatten(dF).
using Mat9 = Eigen::Matrix<double, 9, 9>;
using Vec9 = Eigen::Matrix<double, 9, 1>;

/// The columns of M stacked.
[[nodiscard]] inline Vec9 flatten(const Mat3& M) { return Eigen::Map<const Vec9>(M.data()); }

/// A : B = tr(A^T B) (eq. 2.51).
[[nodiscard]] inline double contract(const Mat3& A, const Mat3& B) {
  return A.cwiseProduct(B).sum();
}

/// J = det F, the ratio of volumes (eq. 4.37). An element with J <= 0 is inside out.
[[nodiscard]] inline double volume_ratio(const Mat3& F) { return F.determinant(); }

/// C = F^T F, the right Cauchy-Green tensor (eq. 4.15).
[[nodiscard]] inline Mat3 right_cauchy_green(const Mat3& F) { return F.transpose() * F; }

/// I1 = tr C (eq. 6.19).
[[nodiscard]] inline double first_invariant(const Mat3& F) { return F.squaredNorm(); }

/// sigma = P F^T / J, the true stress (eq. 5.45).
[[nodiscard]] inline Mat3 cauchy_stress(const Mat3& P, const Mat3& F) {
  return P * F.transpose() / F.determinant();
}

}  // namespace lefort::fem
