/// \file
/// Plots of the convergence of the solver.
#pragma once

#include <lefort/report/case_report.h>
#include <lefort/report/plot_lines.h>

#include <span>

namespace lefort::report {

/// \param steps      of the path, in order.
/// \param tolerance  of the relative residual.
/// \returns the plot of the relative residual over all Newton iterations, with dividers between
///   steps and the tolerance.
[[nodiscard]] LinePlot residual_plot(std::span<const SolverStep> steps, double tolerance);

/// \param steps  of the path, in order.
/// \returns the plot of the maximum and mean penetration over the path fraction.
[[nodiscard]] LinePlot penetration_plot(std::span<const SolverStep> steps);

}  // namespace lefort::report
