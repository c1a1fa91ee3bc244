#include <lefort/mesh/box_grid.h>
#include <lefort/verify/case_model.h>
#include <lefort/verify/cases.h>
#include <lefort/verify/example_laws.h>
#include <lefort/verify/shapes.h>

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace lefort::verify {
namespace {

/// Relative residuals below this are round-off; Newton stops.
constexpr double kRoundOff = 3e-14;

/// A cube of 2 x 2 x 2 cells, 1 mm a side, with a fixed base and a moved top.
CaseModel sheared_block(mesh::ElementShape shape, const fem::Material& law) {
  CaseModel model{.mesh = mesh::make_box(shape, {2, 2, 2}, Vec3::Ones()),
                  .materials = {{0, law}},
                  .prescribed = {}};
  std::vector<fem::PrescribedDisplacement> prescribed;
  const Vec3 top_mm(0.3, 0.1, -0.15);
  for (int c = 0; c < 3; ++c) {
    prescribe(model.mesh.node_sets.at("z0"), c, 0.0, prescribed);
    prescribe(model.mesh.node_sets.at("z1"), c, top_mm[c], prescribed);
  }
  model.prescribed = in_proportion(std::move(prescribed));
  return model;
}

/// A sequence has only two or three residuals near the solution above round-off, too few for an
/// exponent. The same equilibrium is therefore computed from several starts on one path: the last
/// increment of runs with these numbers of increments.
constexpr std::array kRuns{2, 4, 8, 16};

/// Relative tolerance of those runs; their first increments have small forces.
constexpr double kRunTolerance = 1e-10;

/// Relative residuals, one per iteration.
using Residuals = std::vector<double>;

/// The exponent p of r_(k+1) = C_k r_k^p, by least squares over all residuals near the solution and
/// above round-off. Iterations with the same number k, from starts on one path, approach the
/// solution from one side and have one constant C_k.
struct Fit {
  double exponent = NAN;  ///< NaN if there are too few.
  int pairs = 0;          ///< Of consecutive residuals.
};

Fit fit(const std::vector<Residuals>& sequences) {
  constexpr double kNear = 0.1;
  constexpr int kMinPairs = 4;
  Fit found;
  double sum_xx = 0.0, sum_xy = 0.0;  // About the means of each iteration.
  for (std::size_t k = 0; k < 10; ++k) {
    std::vector<std::pair<double, double>> pairs;
    for (const Residuals& r : sequences)
      if (k + 1 < r.size() && r[k] < kNear && r[k + 1] > kRoundOff)
        pairs.emplace_back(std::log(r[k]), std::log(r[k + 1]));
    if (pairs.size() < 2) continue;
    double x = 0.0, y = 0.0;
    for (const auto& [before, after] : pairs) {
      x += before / double(pairs.size());
      y += after / double(pairs.size());
    }
    for (const auto& [before, after] : pairs) {
      sum_xx += (before - x) * (before - x);
      sum_xy += (before - x) * (after - y);
    }
    found.pairs += int(pairs.size());
  }
  if (found.pairs >= kMinPairs) found.exponent = sum_xy / sum_xx;
  return found;
}

Residuals residuals_of(const fem::LoadAttempt& attempt) {
  Residuals residuals;
  for (const fem::NewtonIterate& iterate : attempt.history)
    residuals.push_back(iterate.residual_n / iterate.residual_reference_n);
  return residuals;
}

/// The first sequence is that of the whole load in one increment; the others are those of the last
/// increments of the runs.
Result<std::vector<Residuals>> residuals_of(const CaseModel& model, Progress& progress) {
  LEFORT_TRY(const Equilibrium whole, solve(model, {.relative_tolerance = kRoundOff}, progress));
  std::vector<Residuals> sequences{residuals_of(whole.attempts.back())};
  for (const int increments : kRuns) {
    LEFORT_TRY(
        const Equilibrium found,
        solve(model, {.increments = increments, .relative_tolerance = kRunTolerance}, progress));
    sequences.push_back(residuals_of(found.attempts.back()));
  }
  return sequences;
}

/// Solves the block with one law and one shape, and adds row, line and check.
void measure_newton(const NamedLaw& one, mesh::ElementShape shape, Table& table,
                    report::LinePlot& plot, Section& section, Progress& progress) {
  const std::string name = fmt::format("{}, {}", one.name, text_of(shape));
  const auto found = residuals_of(sheared_block(shape, one.law), progress);
  if (!found) {
    section.checks.push_back(not_measured(name, found.error().message));
    return;
  }
  const Residuals& residuals = found->front();
  std::string text;
  report::PlotLine line{.name = shape == mesh::ElementShape::kHex8 ? one.name : text_of(shape)};
  for (const double residual : residuals) {
    text += fmt::format("{}{:.1e}", text.empty() ? "" : ", ", residual);
    line.x.push_back(double(line.x.size()));
    line.y.push_back(residual);
  }
  plot.lines.push_back(std::move(line));
  if (std::holds_alternative<fem::LinearElastic>(one.law)) {
    table.rows.push_back({one.name, text_of(shape), text, "", "linear"});
    section.checks.push_back({.name = fmt::format("{}: iterations", name),
                              .measured = double(residuals.size()) - 1.0,
                              .comparison = Comparison::kAtMost,
                              .expected = 1.0,
                              .reason = "one step solves a linear problem"});
    return;
  }
  const Fit found_fit = fit({found->begin() + 1, found->end()});
  table.rows.push_back({one.name, text_of(shape), text, fmt::format("{}", found_fit.pairs),
                        fmt::format("{:.2f}", found_fit.exponent)});
  section.checks.push_back({.name = fmt::format("{}: exponent", name),
                            .measured = found_fit.exponent,
                            .comparison = Comparison::kAtLeast,
                            .expected = 2.0,
                            .tolerance = 0.2,
                            .reason = "the exponent is 2 in the limit; a wrong tangent gives 1"});
}

Section newton_section() {
  return {.name = "newton",
          .title = "Newton's method converges quadratically",
          .text =
              "A cube of 2 x 2 x 2 cells is sheared by 0.3 and 0.1 and compressed by 0.15 of its "
              "height; bulk modulus 20 times the shear modulus, volumetric averaging. Near the "
              "solution "
              "each residual must vary as the square of the one before, if the tangent is the "
              "derivative of the forces (Nocedal and Wright, Numerical Optimization, theorem 3.5). "
              "Few residuals lie between that region and round-off; therefore the same equilibrium "
              "is computed from several starts, the last of 2, 4, 8 and 16 increments. The "
              "exponent is the slope of ln r_(k+1) over ln r_k by least squares, over all of these "
              "residuals between 0.1 and 3e-14 of the forces, with one constant for each k; a "
              "linear law needs no iteration. Every law with hex8, and every shape with the "
              "isochoric neo-Hookean law."};
}

}  // namespace

Section verify_newton(Extent /*extent*/, Progress& progress) {
  Section section = newton_section();
  Table table{
      .title =
          "Relative residuals with the whole load in one increment; exponent from several starts",
      .header = {"law", "shape", "residuals, one per iteration", "pairs", "exponent"}};
  report::LinePlot plot{.title = "Newton's method: relative residual",
                        .x_label = "iteration",
                        .y_label = "residual over forces",
                        .y_axis = report::Axis::kLog};
  for (const NamedLaw& one : example_laws(20.0)) {
    measure_newton(one, mesh::ElementShape::kHex8, table, plot, section, progress);
    if (one.name != "isochoric neo-Hookean") continue;
    for (const mesh::ElementShape shape : kAllShapes)
      if (shape != mesh::ElementShape::kHex8)
        measure_newton(one, shape, table, plot, section, progress);
  }
  section.tables.push_back(std::move(table));
  section.plots.push_back(std::move(plot));
  return section;
}

}  // namespace lefort::verify
