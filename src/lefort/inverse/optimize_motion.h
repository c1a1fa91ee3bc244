/// \file
/// The movement whose predicted face is closest to a target, by a coarse model that fine solves
/// correct.
///
/// Let d_c(x) and d_f(x) be the displacements of the skin by the coarse and the fine model, J(d)
/// the objective. Defect correction by output space mapping (\cite bandler2004; \cite
/// echeverria2008):
///
///   x_0     = argmin J(d_c(x))
///   x_(k+1) = argmin J(d_c(x) + d_f(x_k) - d_c(x_k))
///
/// At a fixed point the corrected coarse face is the fine face. If that reaches the target, the
/// fixed point is a minimum of J(d_f) exactly; if not, up to the difference of the derivatives
/// of the two models. The iteration contracts if the derivatives of the models differ by less than
/// half (docs/theory/inverse.md).
///
/// Bounds hold in every iterate. Bone overlap is a penalty in J; a result that exceeds the limit is
/// moved back towards a point that does not, by bisection.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/inverse/bounded_least_squares.h>
#include <lefort/inverse/determined_motions.h>
#include <lefort/inverse/face_objective.h>

#include <functional>
#include <optional>
#include <vector>

namespace lefort::inverse {

struct MotionOptions {
  LeastSquaresOptions coarse{};
  int max_corrections = 8;             ///< Fine solves, >= 1.
  double correction_tolerance = 0.01;  ///< Ends if x changes by less [mm, deg].
  /// Step of the central differences of the gradient check [mm, deg]; 0: no check. A vertex of the
  /// skin whose closest point of a target surface jumps within the step adds an error, so that a
  /// small step is better, down to the error of the equilibria.
  double check_step = 2e-4;
};

/// One fine solve.
struct Correction {
  VectorX x;
  double coarse_objective = 0.0;  ///< J of the corrected coarse face at x.
  double fine_objective = 0.0;    ///< J of the fine face at x.
  double step = 0.0;              ///< Largest change of a number since the last fine solve.
};

struct MotionResult {
  FaceAt face;  ///< Of the fine model, or of the coarse one if there is no fine model.
  std::vector<LeastSquaresIterate> history;  ///< All solves of the coarse model.
  std::vector<std::size_t> starts;           ///< First entry of `history` of each minimization.
  std::vector<Correction> corrections;
  bool converged = false;
  std::vector<char> at_lower, at_upper;  ///< Active bounds of each number.
  std::vector<MotionDirection> directions;
  Eigen::MatrixXd target_gradients;      ///< FaceObjective::target_gradients() at the end.
  std::optional<double> gradient_error;  ///< Relative, at the start.
  DeepestOverlap overlap;                ///< At the result.
  bool is_limited_by_overlap = false;    ///< The result was moved back, or the penalty acts.
};

/// Reports what has been found so far: "coarse model: ..."; may be empty.
using OnMotionNote = std::function<void(const std::string&)>;

/// \param coarse   the model that is minimized.
/// \param fine     the model that corrects it; null: the coarse model is final.
/// \param start    numbers of the movements; \pre within the bounds.
/// \returns the result; or
///   - kInvalidArgument  the bones overlap more than allowed at the start, in the given plan and
///     without movement;
///   - kNotConverged     a model finds no equilibrium at the start;
///   - kCancelled, kOutOfMemory.
[[nodiscard]] Result<MotionResult> optimize_motion(LiveFace& coarse, LiveFace* fine,
                                                   const MotionProblem& problem,
                                                   const VectorX& start,
                                                   const MotionOptions& options,
                                                   const OnMotionNote& note, Progress& progress);

}  // namespace lefort::inverse
