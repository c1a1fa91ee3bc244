/// \file
/// Symmetric positive definite linear systems: directly, or by iterations.
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

enum class LinearSolverKind : std::uint8_t {
  kAutomatic,     ///< Directly while that is quick, by multigrid beyond; see docs/decisions/0005.
  kDirect,        ///< Multifrontal Cholesky factorization.
  kReusedFactor,  ///< Conjugate gradients, preconditioned by the factor of an earlier matrix.
  kMultigrid      ///< Conjugate gradients, preconditioned by smoothed aggregation multigrid.
};

struct LinearSolverOptions {
  LinearSolverKind kind = LinearSolverKind::kAutomatic;
  Index direct_rows = 60000;  ///< Automatic: up to so many rows directly, >= 0.
  int max_iterations = 300;   ///< Of conjugate gradients; >= 1.
  std::int64_t memory_bytes = std::int64_t(16) << 30;  ///< What a factor may take, > 0.
};

/// Solves A x = b for one matrix after another; what depends on the pattern alone is kept.
///
/// \note Same bits for any number of threads, and on all processors of one vector width or another
///   that fuse multiplication and addition.
class LinearSolver {
 public:
  explicit LinearSolver(const LinearSolverOptions& options = {});
  ~LinearSolver();
  LinearSolver(LinearSolver&&) noexcept;
  LinearSolver& operator=(LinearSolver&&) noexcept;

  /// Sets the rows' points and axes, from which multigrid makes its near-null space, the rigid
  /// motions. Without them there is no multigrid.
  ///
  /// \param points_L    where each row acts, in the reference configuration [mm].
  /// \param components  along which axis, 0 to 2; as many.
  void set_near_null_space(std::vector<Vec3> points_L, std::vector<std::int32_t> components);

  /// Prepares for solving with A.
  ///
  /// \param A  square, symmetric, lower triangle alone with the whole diagonal, compressed.
  /// \returns kDone, kNotPositiveDefinite, kNotFinite or kOutOfMemory. The iterative kinds may see
  ///   only in solve() that A is not positive definite.
  [[nodiscard]] LinearSolveStatus factorize(const SparseMatrix& A);

  /// \param tolerance  the iterative kinds stop when |b - A x| <= tolerance |b|, > 0.
  /// \returns A^-1 b; or kNotPositiveDefinite, kOutOfMemory, kNotConverged. If automatic, the next
  ///   factorize() after kNotConverged is direct.
  /// \pre the last factorize() returned kDone; b has as many entries as A has columns.
  [[nodiscard]] tl::expected<VectorX, LinearSolveStatus> solve(const VectorX& b,
                                                               double tolerance = 1e-10);

  /// Both; if automatic and multigrid does not converge, directly.
  ///
  /// \param on_factorized  told between the two; may be empty.
  [[nodiscard]] tl::expected<VectorX, LinearSolveStatus> solve(
      const SparseMatrix& A, const VectorX& b, double tolerance = 1e-10,
      const std::function<void()>& on_factorized = {});

  /// What is used for the last matrix: never kAutomatic. \pre factorize() was called.
  [[nodiscard]] LinearSolverKind kind() const;

  /// What it has done so far.
  struct Statistics {
    int analyzes = 0;             ///< Of patterns.
    int factorizations = 0;       ///< Or hierarchies built.
    int iterations = 0;           ///< Of conjugate gradients.
    double factor_entries = 0.0;  ///< Of the present factor, 8 bytes each.
  };
  [[nodiscard]] const Statistics& statistics() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace lefort::linear
