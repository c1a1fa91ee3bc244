/// \file
/// Symmetric positive definite linear systems by sparse Cholesky factorisation.
#pragma once

#include <lefort/core/types.h>
#include <lefort/fem/factorisation.h>
#include <lefort/fem/sparse_matrix.h>

#include <memory>
#include <optional>

namespace lefort::fem {

/// Supernodal Cholesky factorisation (CHOLMOD), ordered by nested dissection (METIS).
///
/// The symbolic analysis is done once per pattern and kept. The dense kernels are those of the BLAS
/// at hand, run on one thread: same bits for any number of threads, on one kind of processor.
class LinearSolver {
 public:
  LinearSolver();
  ~LinearSolver();
  LinearSolver(LinearSolver&&) noexcept;
  LinearSolver& operator=(LinearSolver&&) noexcept;

  /// \param A  square, symmetric, lower triangle alone, compressed.
  [[nodiscard]] Factorisation factorise(const SparseMatrix& A);

  /// \returns A^-1 b, or nothing if memory ran out.
  /// \pre the last factorise() returned kDone; b has as many entries as A has columns.
  [[nodiscard]] std::optional<VectorX> solve(const VectorX& b) const;

  /// Entries of the factor, or 0 before the first analysis: memory is 8 bytes each.
  [[nodiscard]] double factor_entries() const;

 private:
  struct Cholmod;  // Keeps cholmod.h out of this header.
  std::unique_ptr<Cholmod> cholmod_;
};

}  // namespace lefort::fem
