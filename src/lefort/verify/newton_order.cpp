#include <lefort/mesh/box_grid.h>
#include <lefort/verify/case_model.h>
#include <lefort/verify/cases.h>
#include <lefort/verify/example_laws.h>

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace lefort::verify {
namespace {

/// Relative residuals below this are round-off.
constexpr double kRoundOff = 1e-14;

/// A cube of 2 x 2 x 2 cells, 1 mm a side, its base held, its top moved.
CaseModel sheared_block(const fem::Material& law) {
  CaseModel model{.mesh = mesh::make_box(mesh::ElementShape::kHex8, {2, 2, 2}, Vec3::Ones()),
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

/// The exponent p of r_(k+1) = C r_k^p over the last three residuals above round-off.
double exponent(const std::vector<double>& r) {
  std::size_t count = r.size();
  while (count > 0 && !(r[count - 1] > kRoundOff)) --count;
  if (count < 3) return NAN;
  return std::log(r[count - 1] / r[count - 2]) / std::log(r[count - 2] / r[count - 3]);
}

}  // namespace

Section verify_newton(Extent /*extent*/, Progress& progress) {
  Section section{
      .name = "newton",
      .title = "Newton's method converges quadratically",
      .text =
          "A cube of 2 x 2 x 2 hexahedra (hex8, change of volume averaged) is sheared by 0.3 and "
          "0.1 and "
          "compressed by 0.15 of its height in two increments; bulk modulus 20 times the shear "
          "modulus. Near "
          "the solution each residual must go with the square of the one before, if the tangent "
          "is the derivative of the forces (Nocedal and Wright, Numerical Optimization, theorem "
          "3.5). The "
          "exponent is ln(r3/r2) / ln(r2/r1) over the last three residuals above 1e-14 of the "
          "forces; for "
          "a linear law there is nothing to iterate."};
  Table table{.title = "Relative residuals of the last increment",
              .header = {"law", "residuals, one per iteration", "exponent"}};
  report::LinePlot plot{.title = "Newton's method: relative residual",
                        .x_label = "iteration",
                        .y_label = "residual over forces",
                        .y_axis = report::Axis::kLog};
  for (const NamedLaw& one : example_laws(20.0)) {
    const auto found =
        solve(sheared_block(one.law), {.increments = 2, .relative_tolerance = 3e-14}, progress);
    if (!found) {
      section.checks.push_back(not_measured(one.name, found.error().message));
      continue;
    }
    std::vector<double> residuals;
    std::string text;
    report::PlotLine line{.name = one.name};
    for (const fem::NewtonIterate& iterate : found->attempts.back().history) {
      residuals.push_back(iterate.residual_n / iterate.force_scale_n);
      text += fmt::format("{}{:.1e}", text.empty() ? "" : ", ", residuals.back());
      line.x.push_back(double(line.x.size()));
      line.y.push_back(residuals.back());
    }
    plot.lines.push_back(std::move(line));
    if (std::holds_alternative<fem::LinearElastic>(one.law)) {
      table.rows.push_back({one.name, text, "linear"});
      section.checks.push_back({.name = fmt::format("{}: iterations", one.name),
                                .measured = double(residuals.size()) - 1.0,
                                .asked = Asked::kAtMost,
                                .expected = 1.0,
                                .reason = "one step solves a linear problem"});
      continue;
    }
    const double p = exponent(residuals);
    table.rows.push_back({one.name, text, fmt::format("{:.2f}", p)});
    section.checks.push_back({.name = fmt::format("{}: exponent", one.name),
                              .measured = p,
                              .asked = Asked::kAtLeast,
                              .expected = 2.0,
                              .tolerance = 0.2,
                              .reason = "the exponent is 2 in the limit; a wrong tangent gives 1"});
  }
  section.tables.push_back(std::move(table));
  section.plots.push_back(std::move(plot));
  return section;
}

}  // namespace lefort::verify
