/// \file
/// Preconditioned conjugate gradients.
#pragma once

#include <lefort/core/parallel.h>
#include <lefort/core/types.h>

#include <cmath>
#include <cstdint>
#include <utility>

namespace lefort::linear {

/// Why the iteration ended.
enum class CgStop : std::uint8_t {
  kConverged,
  kTooManyIterations,
  kNotPositiveDefinite,  ///< A direction with non-positive curvature was found.
  kBadPreconditioner     ///< The preconditioner is not positive definite.
};

struct CgOutcome {
  CgStop stop = CgStop::kTooManyIterations;
  VectorX x;  ///< The last iterate.
  int iterations = 0;
};

/// The inner product a . b. The order of the sum depends on the size only, so the result has the
/// same bits for any number of threads.
[[nodiscard]] inline double inner_product(const VectorX& a, const VectorX& b) {
  constexpr Index kBlockSize = 4096;
  return deterministic_sum((a.size() + kBlockSize - 1) / kBlockSize, 0.0, [&](Index part) {
    const Index begin = part * kBlockSize, size = std::min(kBlockSize, a.size() - begin);
    return a.segment(begin, size).dot(b.segment(begin, size));
  });
}

/// Solves A x = b until |b - A x| <= tolerance |b| (\cite nocedal2006, algorithm 5.3).
///
/// \param multiply        multiply(x, y): y = A x.
/// \param precondition    precondition(r, z): z = M^-1 r, M symmetric positive definite.
/// \param b               right-hand side.
/// \param start           initial iterate.
/// \param tolerance       relative residual to be reached.
/// \param max_iterations  >= 0.
/// \returns the last iterate and why the iteration ended.
template <class Multiply, class Precondition>
[[nodiscard]] CgOutcome conjugate_gradients(const Multiply& multiply,
                                            const Precondition& precondition, const VectorX& b,
                                            VectorX start, double tolerance, int max_iterations) {
  CgOutcome outcome{.x = std::move(start)};
  VectorX r = b, z, Ap;
  if (!outcome.x.isZero(0.0)) {
    multiply(outcome.x, Ap);
    r -= Ap;
  }
  const double wanted = tolerance * std::sqrt(inner_product(b, b));
  const auto converged = [&] { return std::sqrt(inner_product(r, r)) <= wanted; };
  VectorX p;
  double rz = 0.0;
  while (!converged()) {
    if (outcome.iterations == max_iterations) return outcome;
    precondition(r, z);
    const double rz_before = std::exchange(rz, inner_product(r, z));
    if (!(rz > 0.0)) {  // Also if NaN.
      outcome.stop = CgStop::kBadPreconditioner;
      return outcome;
    }
    if (outcome.iterations == 0)
      p = z;
    else
      p = z + (rz / rz_before) * p;
    multiply(p, Ap);
    const double curvature = inner_product(p, Ap);
    if (!(curvature > 0.0)) {
      outcome.stop = CgStop::kNotPositiveDefinite;
      return outcome;
    }
    outcome.x += (rz / curvature) * p;
    r -= (rz / curvature) * Ap;
    ++outcome.iterations;
  }
  outcome.stop = CgStop::kConverged;
  return outcome;
}

}  // namespace lefort::linear
