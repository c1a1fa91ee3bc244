/// \file
/// Kinematics of all material laws. Symbols: \cite bonet2008.
///
/// X is the reference position and x the current one. The deformation gradient F maps dX to dx
/// and has no unit.
#pragma once

#include <lefort/core/types.h>

namespace lefort::fem {

/// A linear map between 3x3 matrices whose columns are stacked: entry (i, J) has the number
/// i + 3 J. dP = A : dF is flatten(dP) = A * flatten(dF).
using Mat9 = Eigen::Matrix<double, 9, 9>;
using Vec9 = Eigen::Matrix<double, 9, 1>;

/// \returns the stacked columns of M.
[[nodiscard]] inline Vec9 flatten(const Mat3& M) { return Eigen::Map<const Vec9>(M.data()); }

/// A : B = tr(A^T B).
[[nodiscard]] inline double contract(const Mat3& A, const Mat3& B) {
  return A.cwiseProduct(B).sum();
}

/// J = det F, the ratio of current to reference volume. With J <= 0 an element is inverted.
[[nodiscard]] inline double volume_ratio(const Mat3& F) { return F.determinant(); }

/// J - 1, from H = F - I without cancellation: accurate for small changes.
[[nodiscard]] inline double jacobian_minus_one(const Mat3& F) {
  const Mat3 H = F - Mat3::Identity();
  const double trace = H.trace();
  const double second = 0.5 * (trace * trace - contract(H, H.transpose()));
  return trace + second + H.determinant();
}

/// dJ/dF = J F^-T, for any F; it maps reference to current area vectors (Nanson).
[[nodiscard]] inline Mat3 cofactor(const Mat3& F) {
  Mat3 columns;
  columns << F.col(1).cross(F.col(2)), F.col(2).cross(F.col(0)), F.col(0).cross(F.col(1));
  return columns;
}

/// d2J/dF2, symmetric and linear in F.
[[nodiscard]] inline Mat9 cofactor_tangent(const Mat3& F) {
  Mat9 A = Mat9::Zero();
  for (int K = 0; K < 3; ++K) {
    // K, L, M in cyclic order: column K is F.col(L) x F.col(M), column M is F.col(K) x F.col(L).
    const int L = (K + 1) % 3;
    const int M = (K + 2) % 3;
    Mat3 spin;  // v -> F.col(L) x v.
    spin << 0.0, -F(2, L), F(1, L), F(2, L), 0.0, -F(0, L), -F(1, L), F(0, L), 0.0;
    A.block<3, 3>(3 * M, 3 * K) = -spin;
    A.block<3, 3>(3 * K, 3 * M) = spin;
  }
  return A;
}

/// Terms of tangents: A += [dF -> B dF].
inline void add_left_product(const Mat3& B, Mat9& A) {
  for (int K = 0; K < 3; ++K) A.block<3, 3>(3 * K, 3 * K) += B;
}

/// A += [dF -> dF S], S symmetric.
inline void add_right_product(const Mat3& S, Mat9& A) {
  for (int K = 0; K < 3; ++K)
    for (int J = 0; J < 3; ++J) A.block<3, 3>(3 * J, 3 * K).diagonal().array() += S(J, K);
}

/// A += [dF -> factor M dF^T M]; for M = F^-T the derivative of -factor F^-T.
inline void add_transposed_product(double factor, const Mat3& M, Mat9& A) {
  for (int K = 0; K < 3; ++K)
    for (int k = 0; k < 3; ++k) A.col(k + 3 * K).reshaped(3, 3) += factor * M.col(K) * M.row(k);
}

/// C = F^T F, the right Cauchy-Green tensor.
[[nodiscard]] inline Mat3 right_cauchy_green(const Mat3& F) { return F.transpose() * F; }

/// I1 = tr C.
[[nodiscard]] inline double first_invariant(const Mat3& F) { return F.squaredNorm(); }

/// sigma = P F^T / J, the Cauchy stress.
[[nodiscard]] inline Mat3 cauchy_stress(const Mat3& P, const Mat3& F) {
  return P * F.transpose() / F.determinant();
}

}  // namespace lefort::fem
