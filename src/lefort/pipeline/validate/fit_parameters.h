/// \file
/// Fits few bounded parameters to the residuals of several cases, by the Gauss-Newton method with
/// Levenberg-Marquardt damping and finite differences \cite nocedal2006, section 10.3.
/// Reads no file.
#pragma once

#include <lefort/compare/bootstrap.h>
#include <lefort/core/error.h>
#include <lefort/core/types.h>

#include <Eigen/Core>

#include <functional>
#include <span>
#include <vector>

namespace lefort::pipeline {

/// The error of one case at one set of parameters.
struct CaseResidual {
  std::vector<double> signed_mm;  ///< One per point; NaN if the point is not compared.
  std::vector<double> weight;     ///< One per point, > 0; the same for all parameters.
};

/// Parameters are coordinates from 0 to 1 between their bounds.
struct FitProblem {
  std::vector<double> difference_step;  ///< Of the finite differences, one per parameter; > 0.
  /// Number of points and weights do not depend on the parameters. An error for which `is_of_case`
  /// is true means that the case has no result at these parameters; others end the fit.
  std::function<Result<CaseResidual>(Index number, const VectorX& at)> residual;
  std::function<bool(const Error&)> is_of_case;
};

struct FitOptions {
  int max_iterations = 8;   ///< >= 1.
  double tolerance = 2e-3;  ///< Converged when no coordinate changes by more than this.
  double max_step = 0.3;    ///< Of a coordinate, in one iteration.
};

/// Objective of one case and its derivatives.
struct CaseLinearization {
  double objective = 0.0;     ///< Weighted mean of squares of the residual [mm^2].
  VectorX gradient;           ///< J^T W r over the sum of the weights [mm^2].
  Eigen::MatrixXd curvature;  ///< J^T W J over the sum of the weights [mm^2].
};

struct ParameterFit {
  VectorX at;              ///< Coordinates, 0 to 1.
  double objective = 0.0;  ///< Mean over the cases [mm^2].
  int iterations = 0;
  bool converged = false;
  std::vector<CaseLinearization> linearized{};  ///< At `at`, one per case of the fit.
};

/// Minimizes the mean over cases of the weighted mean square of their residuals.
///
/// \param problem  residuals.
/// \param cases    numbers of the cases that are fitted, one or more.
/// \param start    coordinates.
/// \param options  see FitOptions.
/// \returns the fit; or the error of a residual that is not of a case, or of a case without a
///   result at the start or at both sides of a difference.
[[nodiscard]] Result<ParameterFit> fit_parameters(const FitProblem& problem,
                                                  std::span<const Index> cases,
                                                  const VectorX& start,
                                                  const FitOptions& options = {});

/// Bootstrap intervals of the parameters over the cases of a fit: each replicate is one
/// Gauss-Newton step with the derivatives of the drawn cases.
///
/// \param fit        as returned by fit_parameters().
/// \param bootstrap  see BootstrapOptions.
/// \returns the interval of each coordinate; NaN for one case.
[[nodiscard]] std::vector<compare::Interval> fit_intervals(
    const ParameterFit& fit, const compare::BootstrapOptions& bootstrap = {});

}  // namespace lefort::pipeline
