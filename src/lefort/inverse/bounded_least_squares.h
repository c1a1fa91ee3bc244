/// \file
/// Levenberg-Marquardt method for least squares with bounds.
///
/// Minimizes J(x) = 1/2 |r(x)|^2 for l <= x <= u. With the gradient g = D^T r and the Gauss-Newton
/// matrix H = D^T D, D = dr/dx, one iteration (\cite nocedal2006, section 10.3; with bounds
/// \cite kanzow2004, \cite bertsekas1982pn):
///
/// 1. Active bounds: x_i at a bound with g_i pointing out of it. Their components do not change.
/// 2. (H + mu I) p = -g in the other components; x' = projection of x + p onto the bounds.
/// 3. rho = (J(x) - J(x')) / (decrease of the quadratic model from x to x').
/// 4. Accept x' if rho > 1e-4. mu decreases if the model is good (rho > 3/4), increases if it is
///    bad (rho < 1/4), by a factor of 4 (\cite nocedal2006, algorithm 4.1, by mu instead of the
///    radius).
///
/// x is in mm and degrees, so that in directions that r does not determine the step of least length
/// is taken in these units.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/core/types.h>

#include <string>
#include <vector>

namespace lefort::inverse {

/// J with its Gauss-Newton model.
struct QuadraticModel {
  VectorX gradient;         ///< g.
  Eigen::MatrixXd hessian;  ///< H.
};

/// The function to be minimized. It may store a state that depends on the points evaluated.
class LeastSquaresFunction {
 public:
  virtual ~LeastSquaresFunction() = default;
  /// \returns J at a trial point; kNotConverged if J cannot be evaluated there.
  [[nodiscard]] virtual Result<double> evaluate(const VectorX& x) = 0;
  /// Makes the last trial point the present one.
  virtual void accept() = 0;
  /// \returns g and H at the present point.
  [[nodiscard]] virtual Result<QuadraticModel> linearize() = 0;
};

struct LeastSquaresOptions {
  int max_iterations = 30;          ///< Trial points, >= 1.
  double step_tolerance = 1e-3;     ///< Ends if a step changes no number by more [mm, deg].
  double gradient_tolerance = 0.0;  ///< Ends if |projected g| is at most this.
  double max_step = 5.0;            ///< Largest change of a number in one step [mm, deg].
};

struct LeastSquaresIterate {
  double objective = 0.0;
  double projected_gradient = 0.0;  ///< Largest component without active bounds.
  double step = 0.0;                ///< Largest change of a number to this point; 0 at the start.
  double damping = 0.0;             ///< mu.
  bool is_accepted = true;
  VectorX x;
};

/// Why it ended.
enum class LeastSquaresStop { kConverged, kTooManyIterations, kNoDecrease };

struct LeastSquaresResult {
  VectorX x;
  double objective = 0.0;
  QuadraticModel model;                  ///< At x.
  std::vector<char> at_lower, at_upper;  ///< Active bounds at x.
  LeastSquaresStop stop = LeastSquaresStop::kConverged;
  std::vector<LeastSquaresIterate> history;
};

/// \param start  \pre lower <= start <= upper.
/// \returns the best point; or an error of the function at the start, kCancelled or kOutOfMemory.
[[nodiscard]] Result<LeastSquaresResult> minimize_least_squares(
    LeastSquaresFunction& function, const VectorX& start, const VectorX& lower,
    const VectorX& upper, const LeastSquaresOptions& options = {},
    Progress& progress = Progress::none());

}  // namespace lefort::inverse
