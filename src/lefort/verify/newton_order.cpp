#include <lefort/mesh/box_grid.h>
#include <lefort/verify/case_model.h>
#include <lefort/verify/cases.h>
#include <lefort/verify/example_laws.h>
#include <lefort/verify/shapes.h>

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace lefort::verify {
namespace {

/// Relative residuals below this are round-off, and Newton stops.
constexpr double kRoundOff = 3e-14;

/// A cube of 2 x 2 x 2 cells, 1 mm a side, its base held, its top moved.
CaseModel sheared_block(mesh::ElementShape shape, const fem::Material& law) {
  CaseModel model{.mesh = mesh::make_box(shape, {2, 2, 2}, Vec3::Ones()),
                  .materials = {{0, law}},
                  .prescribed = {}};
  std::vector<fem::PrescribedDisplacement> prescribed;
  const Vec3 top_mm(0.3, 0.1, -0.15);
  for (int c = 0; c < 3; ++c) {
    hold(model.mesh.node_sets.at("z0"), c, 0.0, prescribed);
    hold(model.mesh.node_sets.at("z1"), c, top_mm[c], prescribed);
  }
  model.prescribed = in_proportion(std::move(prescribed));
  return model;
}

/// The exponent p of r_(k+1) = C r_k^p, by least squares over all residuals near the solution and
/// above round-off; NaN if there are not three.
struct Fit {
  double exponent = NAN;
  int pairs = 0;  ///< Of residuals, one after the other.
};

Fit fit(const std::vector<double>& r) {
  constexpr double kNear = 0.1;
  double n = 0.0, sum_x = 0.0, sum_y = 0.0, sum_xx = 0.0, sum_xy = 0.0;
  for (std::size_t k = 0; k + 1 < r.size(); ++k) {
    if (!(r[k] < kNear) || !(r[k + 1] > kRoundOff)) continue;
    const double x = std::log(r[k]), y = std::log(r[k + 1]);
    n += 1.0;
    sum_x += x;
    sum_y += y;
    sum_xx += x * x;
    sum_xy += x * y;
  }
  if (n < 2.0) return {};
  return {(n * sum_xy - sum_x * sum_y) / (n * sum_xx - sum_x * sum_x), int(n)};
}

}  // namespace

Section verify_newton(Extent /*extent*/, Progress& progress) {
  Section section{
      .name = "newton",
      .title = "Newton's method converges quadratically",
      .text =
          "A cube of 2 x 2 x 2 cells is sheared by 0.3 and 0.1 and compressed by 0.15 of its "
          "height in one increment; bulk modulus 20 times the shear modulus, change of volume "
          "averaged. Near the solution each residual must go with the square of the one before, "
          "if the tangent is the derivative of the forces (Nocedal and Wright, Numerical "
          "Optimization, theorem 3.5). The exponent is the slope of ln r_(k+1) over ln r_k by "
          "least squares, over all residuals of the last increment between 0.1 and 3e-14 of the "
          "forces, three at least; for a linear law there is nothing to iterate. Every law with "
          "hex8, and every shape with the isochoric neo-Hookean law."};
  Table table{.title = "Relative residuals of the last increment",
              .header = {"law", "shape", "residuals, one per iteration", "exponent"}};
  report::LinePlot plot{.title = "Newton's method: relative residual",
                        .x_label = "iteration",
                        .y_label = "residual over forces",
                        .y_axis = report::Axis::kLog};
  const auto measure = [&](const NamedLaw& one, mesh::ElementShape shape) {
    const std::string name = fmt::format("{}, {}", one.name, text_of(shape));
    const auto found = solve(sheared_block(shape, one.law),
                             {.increments = 1, .relative_tolerance = kRoundOff}, progress);
    if (!found) {
      section.checks.push_back(not_measured(name, found.error().message));
      return;
    }
    std::vector<double> residuals;
    std::string text;
    report::PlotLine line{.name = shape == mesh::ElementShape::kHex8 ? one.name : text_of(shape)};
    for (const fem::NewtonIterate& iterate : found->attempts.back().history) {
      residuals.push_back(iterate.residual_n / iterate.force_scale_n);
      text += fmt::format("{}{:.1e}", text.empty() ? "" : ", ", residuals.back());
      line.x.push_back(double(line.x.size()));
      line.y.push_back(residuals.back());
    }
    plot.lines.push_back(std::move(line));
    if (std::holds_alternative<fem::LinearElastic>(one.law)) {
      table.rows.push_back({one.name, text_of(shape), text, "linear"});
      section.checks.push_back({.name = fmt::format("{}: iterations", name),
                                .measured = double(residuals.size()) - 1.0,
                                .asked = Asked::kAtMost,
                                .expected = 1.0,
                                .reason = "one step solves a linear problem"});
      return;
    }
    const Fit found_fit = fit(residuals);
    table.rows.push_back(
        {one.name, text_of(shape), text, fmt::format("{:.2f}", found_fit.exponent)});
    section.checks.push_back({.name = fmt::format("{}: exponent", name),
                              .measured = found_fit.exponent,
                              .asked = Asked::kAtLeast,
                              .expected = 2.0,
                              .tolerance = 0.2,
                              .reason = "the exponent is 2 in the limit; a wrong tangent gives 1",
                              .miss = found_fit.pairs > 2 ? ""
                                                          : "three residuals alone lie near the "
                                                            "solution and above round-off, the "
                                                            "first of them not near enough"});
  };
  for (const NamedLaw& one : example_laws(20.0)) {
    measure(one, mesh::ElementShape::kHex8);
    if (one.name != "isochoric neo-Hookean") continue;
    for (const mesh::ElementShape shape : kAllShapes)
      if (shape != mesh::ElementShape::kHex8) measure(one, shape);
  }
  section.tables.push_back(std::move(table));
  section.plots.push_back(std::move(plot));
  return section;
}

}  // namespace lefort::verify
