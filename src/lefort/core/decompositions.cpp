#include <lefort/core/decompositions.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>

#include <algorithm>

namespace lefort {
namespace {

template <int kSize>
SymmetricEigen<kSize> eigen_of(const Eigen::Matrix<double, kSize, kSize>& A) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, kSize, kSize>> solver(A);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

}  // namespace

SymmetricEigen<3> symmetric_eigen(const Mat3& A) { return eigen_of<3>(A); }
SymmetricEigen<6> symmetric_eigen(const Eigen::Matrix<double, 6, 6>& A) { return eigen_of<6>(A); }

SymmetricEigen<4> tridiagonal_eigen(const Eigen::Vector4d& diagonal, const Vec3& subdiagonal) {
  const double scale = std::max(diagonal.cwiseAbs().maxCoeff(), subdiagonal.cwiseAbs().maxCoeff());
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver;
  solver.computeFromTridiagonal(diagonal / scale, subdiagonal / scale);
  return {scale * solver.eigenvalues(), solver.eigenvectors()};
}

SingularValueDecomposition singular_value_decomposition(const Mat3& A) {
  const Eigen::JacobiSVD<Mat3> svd(A, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return {svd.matrixU(), svd.singularValues(), svd.matrixV()};
}

Vec3 singular_values(const Mat3& A) { return Eigen::JacobiSVD<Mat3>(A).singularValues(); }

Vec3 solve_by_lu(const Mat3& A, const Vec3& b) { return A.partialPivLu().solve(b); }

Eigen::Vector2d solve_by_full_lu(const Eigen::Matrix2d& A, const Eigen::Vector2d& b) {
  return A.fullPivLu().solve(b);
}

}  // namespace lefort
