/// \file
/// Flexible GMRES for nonsymmetric systems, with a preconditioner that may vary.
#pragma once

#include <lefort/core/check.h>
#include <lefort/core/types.h>
#include <lefort/linear/conjugate_gradients.h>

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace lefort::linear {

struct GmresOutcome {
  VectorX x;
  double relative_residual = 0.0;  ///< |b - A x| / |b|.
};

/// Solves A x = b with flexible GMRES without restart (\cite saad2003, algorithm 9.6), starting at
/// x = 0. Stores two vectors per iteration.
///
/// \param multiply        multiply(x): A x.
/// \param precondition    precondition(r): approximately A^-1 r, or nothing if it failed.
/// \param b               right-hand side.
/// \param tolerance       relative residual at which the iteration stops.
/// \param max_iterations  maximum number of iterations; >= 1.
/// \returns the solution and its residual, also if the tolerance was not reached; nothing if the
///   preconditioner failed, or a pivot of the Hessenberg matrix is zero or not finite.
template <class Multiply, class Precondition>
[[nodiscard]] std::optional<GmresOutcome> solve_by_gmres(const Multiply& multiply,
                                                         const Precondition& precondition,
                                                         const VectorX& b, double tolerance,
                                                         int max_iterations) {
  LEFORT_CHECK(max_iterations >= 1);
  const double size = std::sqrt(inner_product(b, b));
  if (size == 0.0) return GmresOutcome{VectorX::Zero(b.size())};
  std::vector<VectorX> V{b / size}, Z;
  Eigen::MatrixXd R = Eigen::MatrixXd::Zero(max_iterations + 1, max_iterations);
  std::vector<std::pair<double, double>> rotations;  // Cosine and sine of the Givens rotations.
  VectorX g = VectorX::Zero(max_iterations + 1);
  g[0] = size;
  for (int j = 0;; ++j) {
    std::optional<VectorX> z = precondition(V.back());
    if (!z) return std::nullopt;
    Z.push_back(*std::move(z));
    VectorX w = multiply(Z.back());
    for (int i = 0; i <= j; ++i) {
      R(i, j) = inner_product(w, V[std::size_t(i)]);
      w -= R(i, j) * V[std::size_t(i)];
    }
    const double next = std::sqrt(inner_product(w, w));
    for (int i = 0; i < j; ++i) {
      const auto [c, s] = rotations[std::size_t(i)];
      const double upper = R(i, j);
      R(i, j) = c * upper + s * R(i + 1, j);
      R(i + 1, j) = c * R(i + 1, j) - s * upper;
    }
    const double pivot = std::hypot(R(j, j), next);
    if (!(pivot > 0.0) || !std::isfinite(pivot)) return std::nullopt;
    rotations.emplace_back(R(j, j) / pivot, next / pivot);
    R(j, j) = pivot;
    g[j + 1] = -rotations.back().second * g[j];
    g[j] *= rotations.back().first;
    const double relative_residual = std::abs(g[j + 1]) / size;
    const int n = j + 1;
    if (relative_residual <= tolerance || n == max_iterations) {
      const VectorX y = R.topLeftCorner(n, n).triangularView<Eigen::Upper>().solve(g.head(n));
      VectorX x = VectorX::Zero(b.size());
      for (int i = 0; i < n; ++i) x += y[i] * Z[std::size_t(i)];
      return GmresOutcome{std::move(x), relative_residual};
    }
    V.push_back(w / next);
  }
}

}  // namespace lefort::linear
