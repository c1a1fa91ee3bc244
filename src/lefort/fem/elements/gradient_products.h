/// \file
/// Products of the matrices of one quadrature point, as loops over the nodes.
///
/// Eigen's products of fixed size would be compiled again for each of seven shapes and each use
/// (docs/studies/build-time.md). Each matrix has one column per node: 3 x nodes, column-major, as
/// ElementNodes.
#pragma once

#include <lefort/core/types.h>
#include <lefort/fem/deformation.h>

namespace lefort::fem {

namespace internal {

/// Sum of a[3 k] b[3 k] by pairwise summation: the sum of the first half plus that of the second.
template <int kCount>
double pairwise_dot(const double* a, const double* b) {
  if constexpr (kCount == 1) {
    return *a * *b;
  } else {
    constexpr int kHalf = kCount / 2;
    return pairwise_dot<kHalf>(a, b) + pairwise_dot<kCount - kHalf>(a + 3 * kHalf, b + 3 * kHalf);
  }
}

/// Sum of a[3 k] b[3 k] in order of k.
template <int kCount>
double ordered_dot(const double* a, const double* b) {
  double sum = *a * *b;
  for (int k = 1; k < kCount; ++k) sum += a[3 * k] * b[3 * k];
  return sum;
}

}  // namespace internal

/// \param a, b  3 x kNodes.
/// \returns a b^T, the sum over nodes of a_k (x) b_k. The order of summation is that of Eigen 3.4
///   with SIMD vectors of two doubles, so that the rounding is that of Eigen's product.
template <int kNodes>
[[nodiscard]] Mat3 sum_of_dyads(const double* a, const double* b) {
  constexpr int kMaxPairwise = 10;
  Mat3 sum;
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 2; ++i) sum(i, j) = internal::ordered_dot<kNodes>(a + i, b + j);
    if constexpr (kNodes <= kMaxPairwise)
      sum(2, j) = internal::pairwise_dot<kNodes>(a + 2, b + j);
    else
      sum(2, j) = internal::ordered_dot<kNodes>(a + 2, b + j);
  }
  return sum;
}

/// product = M columns, both 3 x `nodes`.
void multiply_columns(const Mat3& M, const double* columns, int nodes, double* product);

/// product = M^T columns, both 3 x `nodes`.
void multiply_columns_transposed(const Mat3& M, const double* columns, int nodes, double* product);

/// K_ab += dN_a . A . dN_b dV, contracted over the second index of P and of F (\cite bonet2008,
/// section 9.4).
/// \param A                dP/dF [MPa], symmetric.
/// \param dV               volume of the point [mm^3].
/// \param shape_gradients  dN/dX, 3 x `nodes` [1/mm].
/// \param nodes            number of nodes.
/// \param K                stiffness [N/mm] to which the product is added: column-major, square,
///   3 * `nodes` rows.
void add_point_stiffness(const Mat9& A, double dV, const double* shape_gradients, int nodes,
                         double* K);

/// K += a b^T.
/// \param a, b  `size` x `rank`, column-major; `size` <= 60 (20 nodes), `rank` >= 1.
/// \param K     `size` x `size`, column-major.
void add_low_rank_product(const double* a, const double* b, int size, int rank, double* K);

}  // namespace lefort::fem
