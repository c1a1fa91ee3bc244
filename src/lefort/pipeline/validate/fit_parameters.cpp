#include <lefort/core/check.h>
#include <lefort/pipeline/validate/fit_parameters.h>

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lefort::pipeline {
namespace {

using Eigen::MatrixXd;

double mean_square(const CaseResidual& residual) {
  double sum = 0.0, weights = 0.0;
  for (std::size_t p = 0; p < residual.signed_mm.size(); ++p) {
    const double r = residual.signed_mm[p], w = residual.weight[p];
    if (std::isnan(r)) continue;
    sum += w * r * r;
    weights += w;
  }
  return weights > 0.0 ? sum / weights : std::numeric_limits<double>::infinity();
}

/// The residual at a neighbor of `at` along one coordinate, and the signed distance to it.
struct Neighbor {
  CaseResidual residual;
  double step;
};

Result<Neighbor> neighbor_of(const FitProblem& problem, Index number, const VectorX& at,
                             Index parameter) {
  const double step = problem.difference_step[std::size_t(parameter)];
  double signed_step = at[parameter] + step <= 1.0 ? step : -step;
  for (int attempt = 0;; ++attempt) {
    VectorX there = at;
    there[parameter] = std::clamp(at[parameter] + signed_step, 0.0, 1.0);
    Result<CaseResidual> residual = problem.residual(number, there);
    if (residual) return Neighbor{*std::move(residual), there[parameter] - at[parameter]};
    if (attempt == 1 || !problem.is_of_case(residual.error()))
      return tl::unexpected(std::move(residual).error());
    signed_step = -signed_step;
  }
}

/// Points that are not compared at one of the parameters do not count.
Result<CaseLinearization> linearize(const FitProblem& problem, Index number, const VectorX& at) {
  LEFORT_TRY(const CaseResidual here, problem.residual(number, at));
  std::vector<Neighbor> neighbors;
  for (Index p = 0; p < at.size(); ++p) {
    LEFORT_TRY(neighbors.emplace_back(), neighbor_of(problem, number, at, p));
    LEFORT_CHECK(neighbors.back().residual.signed_mm.size() == here.signed_mm.size());
  }
  CaseLinearization result{mean_square(here), VectorX::Zero(at.size()),
                           MatrixXd::Zero(at.size(), at.size())};
  VectorX row(at.size());
  double weights = 0.0;
  for (std::size_t k = 0; k < here.signed_mm.size(); ++k) {
    const double r = here.signed_mm[k], w = here.weight[k];
    for (Index p = 0; p < at.size(); ++p) {
      const Neighbor& there = neighbors[std::size_t(p)];
      row[p] = (there.residual.signed_mm[k] - r) / there.step;
    }
    if (!row.allFinite() || std::isnan(r)) continue;
    result.gradient += w * r * row;
    result.curvature += w * row * row.transpose();
    weights += w;
  }
  if (weights > 0.0) {
    result.gradient /= weights;
    result.curvature /= weights;
  }
  return result;
}

CaseLinearization mean_of_cases(std::span<const CaseLinearization> all,
                                std::span<const Index> chosen) {
  const Index count = all.front().gradient.size();
  CaseLinearization mean{0.0, VectorX::Zero(count), MatrixXd::Zero(count, count)};
  const double part = 1.0 / double(chosen.size());
  for (const Index k : chosen) {
    mean.objective += part * all[std::size_t(k)].objective;
    mean.gradient += part * all[std::size_t(k)].gradient;
    mean.curvature += part * all[std::size_t(k)].curvature;
  }
  return mean;
}

std::vector<Index> all_of(std::size_t count) {
  std::vector<Index> numbers;
  for (std::size_t k = 0; k < count; ++k) numbers.push_back(Index(k));
  return numbers;
}

/// The Gauss-Newton step with damping, within the bounds. A coordinate at a bound that the step
/// would leave stays there.
VectorX step_of(const CaseLinearization& mean, const VectorX& at, double damping, double max_step) {
  constexpr double kAtBound = 1e-9;
  const Index count = at.size();
  std::vector<bool> is_free(std::size_t(count), true);
  VectorX step = VectorX::Zero(count);
  for (Index round = 0; round <= count; ++round) {
    MatrixXd matrix = mean.curvature;
    VectorX right = -mean.gradient;
    const double floor = 1e-12 * std::max(matrix.diagonal().maxCoeff(), 1e-12);
    for (Index p = 0; p < count; ++p) {
      matrix(p, p) += damping * matrix(p, p) + floor;
      if (is_free[std::size_t(p)]) continue;
      matrix.row(p).setZero();
      matrix.col(p).setZero();
      matrix(p, p) = 1.0;
      right[p] = 0.0;
    }
    step = matrix.ldlt().solve(right).cwiseMax(-max_step).cwiseMin(max_step);
    bool has_left = false;
    for (Index p = 0; p < count; ++p) {
      const bool leaves =
          (at[p] <= kAtBound && step[p] < 0.0) || (at[p] >= 1.0 - kAtBound && step[p] > 0.0);
      if (!leaves) continue;
      is_free[std::size_t(p)] = false;
      has_left = true;
    }
    if (!has_left) break;
  }
  return (at + step).cwiseMax(0.0).cwiseMin(1.0) - at;
}

/// Mean objective of the cases; infinite if a case has no result.
Result<double> objective_at(const FitProblem& problem, std::span<const Index> cases,
                            const VectorX& at) {
  double sum = 0.0;
  for (const Index number : cases) {
    const Result<CaseResidual> residual = problem.residual(number, at);
    if (!residual && !problem.is_of_case(residual.error())) return tl::unexpected(residual.error());
    sum += residual ? mean_square(*residual) : std::numeric_limits<double>::infinity();
  }
  return sum / double(cases.size());
}

Result<std::vector<CaseLinearization>> linearize_all(const FitProblem& problem,
                                                     std::span<const Index> cases,
                                                     const VectorX& at) {
  std::vector<CaseLinearization> all;
  for (const Index number : cases) {
    LEFORT_TRY(all.emplace_back(), linearize(problem, number, at));
  }
  return all;
}

}  // namespace

Result<ParameterFit> fit_parameters(const FitProblem& problem, std::span<const Index> cases,
                                    const VectorX& start, const FitOptions& options) {
  LEFORT_CHECK(!cases.empty());
  LEFORT_CHECK(Index(problem.difference_step.size()) == start.size());
  constexpr double kFirstDamping = 1e-4, kMaxDamping = 1e4;
  ParameterFit fit{.at = start};
  double damping = kFirstDamping;
  LEFORT_TRY(fit.linearized, linearize_all(problem, cases, fit.at));
  while (true) {
    const CaseLinearization mean = mean_of_cases(fit.linearized, all_of(cases.size()));
    fit.objective = mean.objective;
    if (fit.converged || fit.iterations == options.max_iterations) return fit;
    ++fit.iterations;
    bool is_accepted = false;
    while (!is_accepted && !fit.converged) {
      const VectorX step = step_of(mean, fit.at, damping, options.max_step);
      if (step.cwiseAbs().maxCoeff() <= options.tolerance || damping > kMaxDamping) {
        fit.converged = true;
        break;
      }
      LEFORT_TRY(const double objective, objective_at(problem, cases, fit.at + step));
      is_accepted = objective < mean.objective;
      damping = is_accepted ? std::max(0.1 * damping, 1e-8) : std::max(10.0 * damping, 1e-3);
      if (is_accepted) fit.at += step;
    }
    if (!is_accepted) continue;  // Converged.
    LEFORT_TRY(fit.linearized, linearize_all(problem, cases, fit.at));
  }
}

std::vector<compare::Interval> fit_intervals(const ParameterFit& fit,
                                             const compare::BootstrapOptions& bootstrap) {
  const Index count = fit.at.size(), cases = Index(fit.linearized.size());
  std::vector<std::vector<double>> replicates{std::size_t(count)};
  if (cases >= 2) {
    // Relative to the step of all cases, which is not zero if the fit stopped early.
    const VectorX center =
        step_of(mean_of_cases(fit.linearized, all_of(std::size_t(cases))), fit.at, 0.0, 1.0);
    for (const std::vector<Index>& drawn : compare::bootstrap_samples(cases, bootstrap)) {
      const VectorX step = step_of(mean_of_cases(fit.linearized, drawn), fit.at, 0.0, 1.0);
      const VectorX at = (fit.at + step - center).cwiseMax(0.0).cwiseMin(1.0);
      for (Index p = 0; p < count; ++p) replicates[std::size_t(p)].push_back(at[p]);
    }
  }
  std::vector<compare::Interval> intervals;
  for (const std::vector<double>& values : replicates)
    intervals.push_back(compare::percentile_interval(values, bootstrap.level));
  return intervals;
}

}  // namespace lefort::pipeline
