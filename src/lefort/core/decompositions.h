/// \file
/// Decompositions of small matrices, compiled once.
///
/// A decomposition of Eigen is a template: each source file that uses one compiles one to three
/// seconds longer.
/// Methods: \cite golub2013, chapters 3 (LU) and 8 (symmetric eigenvalues, singular values).
#pragma once

#include <lefort/core/types.h>

namespace lefort {

/// A = vectors diag(values) vectors^T.
template <int kSize>
struct SymmetricEigen {
  Eigen::Matrix<double, kSize, 1> values;       ///< Ascending.
  Eigen::Matrix<double, kSize, kSize> vectors;  ///< Columns: orthonormal, in the order of `values`.
};

/// \param A  symmetric; the lower triangle is read.
[[nodiscard]] SymmetricEigen<3> symmetric_eigen(const Mat3& A);
[[nodiscard]] SymmetricEigen<6> symmetric_eigen(const Eigen::Matrix<double, 6, 6>& A);

/// \param diagonal     of a symmetric tridiagonal matrix. \pre the matrix is not zero.
/// \param subdiagonal  entries below the diagonal.
[[nodiscard]] SymmetricEigen<4> tridiagonal_eigen(const Eigen::Vector4d& diagonal,
                                                  const Vec3& subdiagonal);

/// A = U diag(values) V^T.
struct SingularValueDecomposition {
  Mat3 U;
  Vec3 values;  ///< Descending, >= 0.
  Mat3 V;
};

[[nodiscard]] SingularValueDecomposition singular_value_decomposition(const Mat3& A);

/// \returns the singular values of A, descending.
[[nodiscard]] Vec3 singular_values(const Mat3& A);

/// \returns x with A x = b, by LU with row pivoting; not finite if a pivot is zero.
[[nodiscard]] Vec3 solve_by_lu(const Mat3& A, const Vec3& b);

/// \returns x with A x = b, by LU with full pivoting. If A is singular, the components of x without
///   a pivot are zero.
[[nodiscard]] Eigen::Vector2d solve_by_full_lu(const Eigen::Matrix2d& A, const Eigen::Vector2d& b);

}  // namespace lefort
