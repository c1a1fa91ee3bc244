/// \file
/// Search direction of solve_newton(): steps 3 and 4 of its algorithm.
#pragma once

#include <lefort/core/progress.h>
#include <lefort/fem/solve/newton_state.h>
#include <lefort/linear/linear_solver.h>
#include <lefort/linear/sparse_matrix.h>

#include <optional>

namespace lefort::fem::internal {

struct SearchDirection {
  VectorX dx;                                  ///< By the symmetric tangent.
  TangentModel model;                          ///< That tangent.
  std::optional<VectorX> unsymmetric_dx = {};  ///< By K + A, if A is not 0 and GMRES succeeds.
};

/// Finds the search direction at each state of a solve.
class DirectionFinder {
 public:
  /// All arguments must outlive the finder.
  /// \param options   on_phase and max_diagonal_shift are used.
  /// \param progress  checked before every factorization of a step except its first.
  DirectionFinder(const NonlinearSystem& system, linear::LinearSolver& linear_solver,
                  const NewtonOptions& options, const Progress& progress)
      : system_(system), solver_(linear_solver), options_(options), progress_(progress) {}

  /// Solves with the first positive definite tangent of a sequence: the exact tangent, then growing
  /// tangent blends, then growing diagonal shifts.
  /// \param at         the state.
  /// \param last       tangent of the previous step.
  /// \param tolerance  of an iterative linear solver.
  /// \returns the direction, or kCancelled, kOutOfMemory, kLinearNotConverged or kSingularTangent.
  [[nodiscard]] tl::expected<SearchDirection, NewtonStop> find(const NewtonState& at,
                                                               const TangentModel& last,
                                                               double tolerance);

 private:
  using Solution = tl::expected<VectorX, linear::LinearSolveStatus>;

  /// (K + A) dx = b.
  struct Equations {
    linear::SparseMatrix K;  ///< Exact symmetric part, lower triangle.
    linear::SparseMatrix A;  ///< Antisymmetric part, below the diagonal; may be empty.
    VectorX b;
    double tolerance = 0.0;
  };

  Solution solve(const linear::SparseMatrix& K, const Equations& equations);
  std::optional<VectorX> solve_unsymmetric(const Equations& equations);

  const NonlinearSystem& system_;
  linear::LinearSolver& solver_;
  const NewtonOptions& options_;
  const Progress& progress_;
};

}  // namespace lefort::fem::internal
