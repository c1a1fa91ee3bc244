/// \file
/// Parallel multifrontal Cholesky factorization of sparse matrices.
#pragma once

#include <lefort/core/types.h>
#include <lefort/linear/aligned_buffer.h>
#include <lefort/linear/cholesky_plan.h>
#include <lefort/linear/dense_kernels.h>
#include <lefort/linear/linear_solve_status.h>

#include <cstdint>
#include <optional>
#include <span>

namespace lefort::linear {

/// The factorization A = L L^T.
///
/// Subtrees of the assembly tree are eliminated in parallel, and so are the tiles of the large
/// fronts near the root. Each entry is computed by one task in a fixed order, so results have the
/// same bits for any number of threads, and on all processors that fuse multiplication and
/// addition.
class SparseCholesky {
 public:
  /// \param plan          from plan_cholesky().
  /// \param memory_bytes  limit for factor and fronts [bytes].
  /// \param simd          instruction set of the kernels.
  explicit SparseCholesky(CholeskyPlan plan, std::int64_t memory_bytes,
                          TileSimd simd = best_tile_simd());

  /// Computes the factor.
  ///
  /// \param values  of A, finite, in the order of the pattern of the plan.
  /// \returns kDone, kNotPositiveDefinite or kOutOfMemory.
  [[nodiscard]] LinearSolveStatus factorize(std::span<const double> values);

  /// \param b  right-hand side.
  /// \returns A^-1 b, or nothing if memory was exhausted.
  /// \pre the last factorize() returned kDone.
  [[nodiscard]] std::optional<VectorX> solve(const VectorX& b) const;

  [[nodiscard]] const CholeskyPlan& plan() const { return plan_; }

 private:
  CholeskyPlan plan_;
  std::int64_t memory_bytes_;
  const TileKernels* kernels_;
  AlignedBuffer factor_;
  bool factorized_ = false;
};

}  // namespace lefort::linear
