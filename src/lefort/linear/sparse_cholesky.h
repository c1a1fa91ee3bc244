/// \file
/// Multifrontal Cholesky factorization of sparse matrices on all threads.
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

/// A = L L^T.
///
/// Subtrees of the elimination tree are eliminated side by side, and the large fronts above them
/// tile by tile. Each number is computed by one task in a fixed order: same bits for any number of
/// threads, and on all processors that fuse multiplication and addition.
class SparseCholesky {
 public:
  /// \param memory_bytes  what factor and fronts may take.
  explicit SparseCholesky(CholeskyPlan plan, std::int64_t memory_bytes,
                          TileSimd simd = best_tile_simd());

  /// \param values  those of A, finite, in the order of the pattern that was planned for.
  /// \returns kDone, kNotPositiveDefinite or kOutOfMemory.
  [[nodiscard]] LinearSolveStatus factorize(std::span<const double> values);

  /// \returns A^-1 b, or nothing if memory ran out.
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
