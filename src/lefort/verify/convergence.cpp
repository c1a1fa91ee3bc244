#include <lefort/core/check.h>
#include <lefort/fem/materials/neo_hookean.h>
#include <lefort/mesh/box_grid.h>
#include <lefort/verify/case_model.h>
#include <lefort/verify/cases.h>
#include <lefort/verify/error_norms.h>
#include <lefort/verify/shapes.h>

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

namespace lefort::verify {
namespace {

using std::numbers::pi;

/// u_i = A sin(w . X + phase_i), each component its own waves: no symmetry that a mesh could share.
/// Largest strain about 10 %.
struct Waves {
  static constexpr double kAmplitude_mm = 0.03;
  Mat3 w;  ///< Row i: of component i [1/mm].
  Vec3 phase{0.3, 1.1, 2.0};

  Waves() { w << 2.0, 1.0, 0.5, 0.7, 2.2, -1.0, -0.6, 1.2, 1.8; }

  [[nodiscard]] Vec3 displacement(const Vec3& X) const {
    return kAmplitude_mm * Vec3((w * X + phase).array().sin());
  }
  [[nodiscard]] Mat3 gradient(const Vec3& X) const {
    const Vec3 slope = kAmplitude_mm * Vec3((w * X + phase).array().cos());
    return slope.asDiagonal() * w;
  }
};

/// b = -Div P by central differences of fourth order. With steps of h = 1e-3 mm and waves of 2.5/mm
/// their error is (2.5 h)^4 / 30, 1e-12 of b, and rounding adds 1e-16 / h: below 1e-9 with the
/// higher harmonics that the law makes.
Vec3 body_force(const fem::NeoHookean& law, const Waves& waves, const Vec3& X) {
  constexpr double h_mm = 1e-3;
  Vec3 divergence = Vec3::Zero();
  for (int J = 0; J < 3; ++J) {
    const auto column = [&](double steps) -> Vec3 {
      const Vec3 at = X + steps * h_mm * Vec3::Unit(J);
      return law.stress(Mat3::Identity() + waves.gradient(at)).col(J);
    };
    divergence +=
        (8.0 * (column(1.0) - column(-1.0)) - (column(2.0) - column(-2.0))) / (12.0 * h_mm);
  }
  return -divergence;
}

/// The error on a mesh of so many cells a side, with the size of the displacement on its boundary
/// prescribed.
Result<ErrorNorms> run(mesh::ElementShape shape, int cells, Progress& progress) {
  const fem::NeoHookean law{.mu_mpa = 1.0, .lambda_mpa = 1.5};
  const Waves waves;
  CaseModel model{.mesh = mesh::make_box(shape, {cells, cells, cells}, Vec3::Ones()),
                  .materials = {{0, law}},
                  .prescribed = {}};
  std::vector<fem::PrescribedDisplacement> prescribed;
  for (const std::int32_t node : model.mesh.node_sets.at("boundary")) {
    const Vec3 u = waves.displacement(model.mesh.nodes_L[std::size_t(node)]);
    for (int c = 0; c < 3; ++c) hold({node}, c, u[c], prescribed);
  }
  model.prescribed = in_proportion(std::move(prescribed));
  model.forces = nodal_forces(model.mesh, [&](const Vec3& X) { return body_force(law, waves, X); });
  LEFORT_TRY(const Equilibrium found, solve(model, {}, progress));
  return error_norms(model.mesh, found.u,
                     {.displacement = [&](const Vec3& X) { return waves.displacement(X); },
                      .gradient = [&](const Vec3& X) { return waves.gradient(X); }});
}

report::LinePlot plot(int wanted_degree) {
  return {.title = fmt::format("{} shapes: error of the displacement (L2, relative)",
                               wanted_degree == 1 ? "Linear" : "Quadratic"),
          .x_label = "refinement: log2 of the cells along a side",
          .y_label = "relative error",
          .y_axis = report::Axis::kLog};
}

}  // namespace

Section verify_convergence(Extent extent, Progress& progress) {
  Section section{
      .name = "convergence",
      .title = "Order of convergence: manufactured solutions",
      .text =
          "On a cube of 1 mm the displacement is to be three waves, u_i = 0.03 mm sin(w_i . X + "
          "phase_i), "
          "strains up to about 8 %, in a compressible neo-Hookean body. It is prescribed on the "
          "boundary; "
          "inside, the body force b = -Div P(F(X)) keeps it in balance. The divergence is taken by "
          "central differences of fourth order, right to 1e-9; loads and errors are integrated by "
          "64 "
          "points in every element. As the cells halve, the displacement's error must fall by 4 "
          "for "
          "linear and 8 for quadratic shapes, that of its gradient by 2 and 4 (orders p + 1 and p: "
          "Hughes, The "
          "Finite Element Method, section 4.1)."};
  std::vector<int> cells{2, 4, 8};
  if (extent == Extent::kFull) cells.push_back(16);
  Table table{.title = "Relative errors, and orders between a mesh and the one before",
              .header = {"shape", "cells a side", "L2", "order", "H1", "order"}};
  report::LinePlot plots[2] = {plot(1), plot(2)};
  double done = 0.0;
  for (const mesh::ElementShape shape : kAllShapes) {
    const int p = degree(shape);
    report::PlotLine line{.name = text_of(shape)};
    std::optional<ErrorNorms> coarser;
    double l2_order = NAN;
    double h1_order = NAN;
    for (const int n : cells) {
      const auto errors = run(shape, n, progress);
      progress.report(++done / double(cells.size() * kAllShapes.size()));
      if (!errors) {
        section.checks.push_back(
            not_measured(fmt::format("{}, {} cells", text_of(shape), n), errors.error().message));
        break;
      }
      std::string l2_text = "";
      std::string h1_text = "";
      if (coarser) {
        l2_order = std::log2(coarser->l2 / errors->l2);
        h1_order = std::log2(coarser->h1 / errors->h1);
        l2_text = fmt::format("{:.2f}", l2_order);
        h1_text = fmt::format("{:.2f}", h1_order);
      }
      table.rows.push_back({text_of(shape), fmt::format("{}", n), fmt::format("{:.2e}", errors->l2),
                            l2_text, fmt::format("{:.2e}", errors->h1), h1_text});
      line.x.push_back(std::log2(n));
      line.y.push_back(errors->l2);
      coarser = *errors;
    }
    plots[p - 1].lines.push_back(std::move(line));
    const char* const reason =
        "orders hold in the limit of small cells; on meshes that a test can afford they are 0.2 "
        "off";
    section.checks.push_back(
        {.name = fmt::format("{}: L2 order on the finest meshes", text_of(shape)),
         .measured = l2_order,
         .expected = p + 1.0,
         .tolerance = 0.2,
         .reason = reason});
    section.checks.push_back(
        {.name = fmt::format("{}: H1 order on the finest meshes", text_of(shape)),
         .measured = h1_order,
         .expected = double(p),
         .tolerance = 0.2,
         .reason = reason});
  }
  section.tables.push_back(std::move(table));
  for (report::LinePlot& one : plots) section.plots.push_back(std::move(one));
  return section;
}

}  // namespace lefort::verify
