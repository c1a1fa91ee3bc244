#include <lefort/report/solver_plots.h>

#include <utility>

namespace lefort::report {

LinePlot residual_plot(std::span<const SolverStep> steps, double tolerance) {
  LinePlot plot{.title = "Residual of each Newton iteration",
                .x_label = "Newton iteration, over all load steps",
                .y_label = "relative residual",
                .y_axis = Axis::kLog,
                .lines = {},
                .dividers_x = {},
                .threshold_y = tolerance,
                .threshold_name = "tolerance"};
  double iteration = 0.0;
  for (const SolverStep& step : steps) {
    if (iteration > 0.0) plot.dividers_x.push_back(iteration + 0.5);
    PlotLine line{"residual", {}, {}};
    for (const double residual : step.relative_residuals) {
      line.x.push_back(++iteration);
      line.y.push_back(residual);
    }
    plot.lines.push_back(std::move(line));
  }
  return plot;
}

LinePlot penetration_plot(std::span<const SolverStep> steps) {
  PlotLine maximum{"maximum", {}, {}};
  PlotLine mean{"mean over the contact area", {}, {}};
  for (const SolverStep& step : steps) {
    for (PlotLine* line : {&maximum, &mean}) line->x.push_back(100.0 * step.path_fraction);
    maximum.y.push_back(step.max_penetration_mm);
    mean.y.push_back(step.mean_penetration_mm);
  }
  return {.title = "Penetration of tissue into the obstacle",
          .x_label = "path fraction [%]",
          .y_label = "penetration [mm]",
          .y_axis = Axis::kLinear,
          .lines = {std::move(maximum), std::move(mean)},
          .dividers_x = {},
          .threshold_y = {},
          .threshold_name = {}};
}

}  // namespace lefort::report
