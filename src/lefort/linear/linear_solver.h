/// \file
/// Solver for symmetric positive definite linear systems, direct or iterative.
#pragma once

#include <lefort/core/types.h>
#include <lefort/linear/linear_solve_status.h>
#include <lefort/linear/sparse_matrix.h>

#include <tl/expected.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace lefort::linear {

/// Methods of the solver.
enum class LinearSolverKind : std::uint8_t {
  /// Direct up to direct_rows or without set_near_null_space(), else multigrid
  /// (docs/decisions/0005).
  kAutomatic,
  kDirect,        ///< Multifrontal Cholesky factorization.
  kReusedFactor,  ///< Conjugate gradients, preconditioned by the factor of an earlier matrix.
  /// Conjugate gradients, preconditioned by smoothed aggregation multigrid. Direct up to 3000 rows.
  kMultigrid
};

/// Method and limits of the solver.
struct LinearSolverOptions {
  LinearSolverKind kind = LinearSolverKind::kAutomatic;
  Index direct_rows = 60000;  ///< kAutomatic: largest system that is solved directly, >= 0.
  int max_iterations = 300;   ///< Multigrid: of conjugate gradients, >= 1.
  /// Direct and reused factor: max for factor and fronts, > 0.
  std::int64_t memory_bytes = std::int64_t(16) << 30;
};

/// Solves A x = b for a sequence of matrices. Data that depend on the pattern only are reused.
///
/// \note The results have the same bits for any number of threads, and on all processors that fuse
///   multiplication and addition.
class LinearSolver {
 public:
  explicit LinearSolver(const LinearSolverOptions& options = {});
  ~LinearSolver();
  LinearSolver(LinearSolver&&) noexcept;
  LinearSolver& operator=(LinearSolver&&) noexcept;

  /// Sets the point and the axis of each row, from which multigrid computes the near null space
  /// (the rigid-body modes). kMultigrid requires them; without them kAutomatic is direct.
  ///
  /// \param points_L    where each row acts, in the reference configuration [mm].
  /// \param components  axis along which it acts, 0 to 2; as many as points.
  void set_near_null_space(std::vector<Vec3> points_L, std::vector<std::int32_t> components);

  /// Prepares for solving with A.
  ///
  /// \param A  square and symmetric; lower triangle with the whole diagonal, compressed.
  /// \returns kDone, kNotPositiveDefinite, kNotFinite or kOutOfMemory. Iterative kinds may detect
  ///   an indefinite matrix in solve() only.
  [[nodiscard]] LinearSolveStatus factorize(const SparseMatrix& A);

  /// Solves with the last matrix.
  ///
  /// \param b          right-hand side.
  /// \param tolerance  iterative kinds stop when |b - A x| <= tolerance |b|, > 0.
  /// \returns A^-1 b; or kNotPositiveDefinite, kOutOfMemory, kNotConverged. With kAutomatic the
  ///   next factorize() of the same pattern after kNotConverged is direct.
  /// \pre the last factorize() returned kDone; b has as many entries as A has columns.
  [[nodiscard]] tl::expected<VectorX, LinearSolveStatus> solve(const VectorX& b,
                                                               double tolerance = 1e-10);

  /// Factorizes and solves. With kAutomatic, if multigrid does not converge, solves directly.
  ///
  /// \param A              as in factorize().
  /// \param b              right-hand side.
  /// \param tolerance      as in solve().
  /// \param on_factorized  called after each factorization, before the solution; may be empty.
  /// \returns as factorize() and solve().
  [[nodiscard]] tl::expected<VectorX, LinearSolveStatus> solve(
      const SparseMatrix& A, const VectorX& b, double tolerance = 1e-10,
      const std::function<void()>& on_factorized = {});

  /// The method for the last matrix, never kAutomatic. \pre the last factorize() returned kDone.
  [[nodiscard]] LinearSolverKind kind() const;

  /// Counts since construction.
  struct Statistics {
    int analyses = 0;             ///< Analyses of patterns.
    int factorizations = 0;       ///< Factorizations, or hierarchies built.
    int iterations = 0;           ///< Iterations of conjugate gradients.
    double factor_entries = 0.0;  ///< Of the current factor, 8 bytes each; 0 with multigrid.
  };
  [[nodiscard]] const Statistics& statistics() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace lefort::linear
