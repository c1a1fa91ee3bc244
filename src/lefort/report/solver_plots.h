/// \file
/// How the solver came to its result, as plots.
#pragma once

#include <lefort/report/case_report.h>
#include <lefort/report/plot_lines.h>

#include <span>

namespace lefort::report {

/// Relative residual over all Newton iterations of the path, one after another, a divider between
/// steps, with the tolerance.
[[nodiscard]] LinePlot residual_plot(std::span<const SolverStep> steps, double tolerance);

/// Largest and mean penetration over the share of the path that is done.
[[nodiscard]] LinePlot penetration_plot(std::span<const SolverStep> steps);

}  // namespace lefort::report
