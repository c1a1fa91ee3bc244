#include <lefort/core/check.h>
#include <lefort/fem/materials/material.h>
#include <lefort/mesh/box_grid.h>
#include <lefort/verify/case_model.h>
#include <lefort/verify/cases.h>
#include <lefort/verify/error_norms.h>
#include <lefort/verify/shapes.h>

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

namespace lefort::verify {
namespace {

using std::numbers::pi;

/// u_i = A sin(w_i . X + phase_i), with different waves for each component, so that no mesh has the
/// same symmetry. Largest strain about 10 %.
struct Waves {
  static constexpr double kAmplitude_mm = 0.03;
  Mat3 w;  ///< Row i: of component i [1/mm].
  Vec3 phase{0.3, 1.1, 2.0};

  /// \param solenoidal  no component varies along its own axis: the volume changes to second order.
  explicit Waves(bool solenoidal) {
    w << 2.0, 1.0, 0.5, 0.7, 2.2, -1.0, -0.6, 1.2, 1.8;
    if (solenoidal) w.diagonal().setZero();
  }

  [[nodiscard]] Vec3 displacement(const Vec3& X) const {
    return kAmplitude_mm * Vec3((w * X + phase).array().sin());
  }
  [[nodiscard]] Mat3 gradient(const Vec3& X) const {
    const Vec3 slope = kAmplitude_mm * Vec3((w * X + phase).array().cos());
    return slope.asDiagonal() * w;
  }
};

/// b = -Div P by central differences of fourth order. With steps of h = 1e-3 mm and waves of 2.5/mm
/// their error is (2.5 h)^4 / 30, 1e-12 of b, and rounding adds 1e-16 / h: below 1e-9 including the
/// higher harmonics of the law.
template <class Law>
Vec3 body_force(const Law& law, const Waves& waves, const Vec3& X) {
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

/// Error on a mesh with `cells` per side and prescribed displacements on the boundary.
template <class Law>
Result<ErrorNorms> run(mesh::ElementShape shape, int cells, const Law& law, const Waves& waves,
                       Progress& progress) {
  CaseModel model{.mesh = mesh::make_box(shape, {cells, cells, cells}, Vec3::Ones()),
                  .materials = {{0, law}},
                  .prescribed = {}};
  std::vector<fem::PrescribedDisplacement> prescribed;
  for (const std::int32_t node : model.mesh.node_sets.at("boundary")) {
    const Vec3 u = waves.displacement(model.mesh.nodes_L[std::size_t(node)]);
    for (int c = 0; c < 3; ++c) prescribe({node}, c, u[c], prescribed);
  }
  model.prescribed = in_proportion(std::move(prescribed));
  model.forces = nodal_forces(model.mesh, [&](const Vec3& X) { return body_force(law, waves, X); });
  LEFORT_TRY(const Equilibrium found, solve(model, {}, progress));
  return error_norms(model.mesh, found.u,
                     {.displacement = [&](const Vec3& X) { return waves.displacement(X); },
                      .gradient = [&](const Vec3& X) { return waves.gradient(X); }});
}

report::LinePlot plot(const std::string& law, int wanted_degree) {
  return {.title = fmt::format("{}, {} shapes: error of the displacement (L2, relative)", law,
                               wanted_degree == 1 ? "linear" : "quadratic"),
          .x_label = "refinement: log2 of the cells along a side",
          .y_label = "relative error",
          .y_axis = report::Axis::kLog};
}

/// Theoretical orders of both norms.
struct Orders {
  double l2 = 0.0, h1 = 0.0;
};

/// A law, its manufactured solution and the expected orders.
template <class Law>
struct Problem {
  std::string name;
  Law law;
  Waves waves;
  std::span<const mesh::ElementShape> shapes;
  Orders (*orders)(mesh::ElementShape);
  Comparison comparison;  ///< Of the orders.
  std::string reason;
  std::string known_failure = "";  ///< Why orders are known to fail; or empty.
  int max_cells = 16;              ///< Per side, of quadratic shapes.
};

/// p + 1 and p.
Orders full_orders(mesh::ElementShape shape) {
  return {degree(shape) + 1.0, double(degree(shape))};
}

/// Nodal quadrature of p / kappa is exact for linear functions only: order 2 in the L2 norm. A
/// pressure on the boundary takes J at the centroid of its function, at a distance of the first
/// order, in a layer as thick as an element: order 1.5 of the pressure and of H1.
Orders averaged_orders(mesh::ElementShape shape) {
  return degree(shape) == 1 ? full_orders(shape) : Orders{2.0, 1.5};
}

template <class Law>
void measure(const Problem<Law>& problem, const std::vector<int>& cells, Section& section,
             Progress& progress) {
  Table table{
      .title = fmt::format("{}: relative errors, and orders between a mesh and the one before",
                           problem.name),
      .header = {"shape", "cells per side", "L2", "order", "H1", "order"}};
  report::LinePlot plots[2] = {plot(problem.name, 1), plot(problem.name, 2)};
  for (const mesh::ElementShape shape : problem.shapes) {
    report::PlotLine line{.name = text_of(shape)};
    std::optional<ErrorNorms> coarser;
    Orders found{NAN, NAN};
    const std::string name = fmt::format("{}, {}", problem.name, text_of(shape));
    for (const int n : cells) {
      if (n > problem.max_cells && degree(shape) == 2) break;
      const auto errors = run(shape, n, problem.law, problem.waves, progress);
      if (!errors) {
        section.checks.push_back(
            not_measured(fmt::format("{}, {} cells", name, n), errors.error().message));
        break;
      }
      if (coarser)
        found = {std::log2(coarser->l2 / errors->l2), std::log2(coarser->h1 / errors->h1)};
      const auto text = [&](double order) {
        return coarser ? fmt::format("{:.2f}", order) : std::string();
      };
      table.rows.push_back({text_of(shape), fmt::format("{}", n), fmt::format("{:.2e}", errors->l2),
                            text(found.l2), fmt::format("{:.2e}", errors->h1), text(found.h1)});
      line.x.push_back(std::log2(n));
      line.y.push_back(errors->l2);
      coarser = *errors;
    }
    plots[degree(shape) - 1].lines.push_back(std::move(line));
    const Orders wanted = problem.orders(shape);
    const auto add_check = [&](const char* norm, double measured, double expected) {
      section.checks.push_back(
          {.name = fmt::format("{}: {} order on the finest meshes", name, norm),
           .measured = measured,
           .comparison = problem.comparison,
           .expected = expected,
           .tolerance = 0.2,
           .reason = problem.reason,
           .known_failure = problem.known_failure});
    };
    add_check("L2", found.l2, wanted.l2);
    add_check("H1", found.h1, wanted.h1);
  }
  section.tables.push_back(std::move(table));
  for (report::LinePlot& one : plots) section.plots.push_back(std::move(one));
}

}  // namespace

Section verify_convergence(Extent extent, Progress& progress) {
  constexpr double kKappa_mpa = 100.0;
  Section section{
      .name = "convergence",
      .title = "Order of convergence: manufactured solutions",
      .text = fmt::format(
          "On a cube of 1 mm the exact displacement is three waves, u_i = 0.03 mm sin(w_i . X + "
          "phase_i), with strains up to about 8 %. It is prescribed on the boundary; inside, the "
          "body force b = -Div P(F(X)) acts, so that it is an equilibrium. The divergence is "
          "computed by central differences of fourth order, correct to 1e-9; loads and errors are "
          "integrated with 64 points in every element. When the cell size is halved, the error of "
          "the displacement must decrease by a factor of 4 for linear and 8 for quadratic shapes, "
          "and that of its gradient by 2 and 4 (orders p + 1 and p: Hughes, The Finite Element "
          "Method, section 4.1). There are two laws: a compressible neo-Hookean one, and a "
          "decoupled one with bulk over shear modulus {:.0f} and the volumetric averaging of "
          "each shape. With the second law the waves are transverse, so that the volume changes "
          "only "
          "to second order.",
          kKappa_mpa)};
  std::vector<int> cells{2, 4, 8};
  if (extent == Extent::kFull) cells.push_back(16);
  measure(Problem<fem::NeoHookean>{.name = "neo-Hookean",
                                   .law = {.mu_mpa = 1.0, .lambda_mpa = 1.5},
                                   .waves = Waves(false),
                                   .shapes = kAllShapes,
                                   .orders = full_orders,
                                   .comparison = Comparison::kNear,
                                   .reason = "orders hold in the limit of small cells; on the "
                                             "meshes of a test they differ by up to 0.2"},
          cells, section, progress);
  measure(
      Problem<fem::DecoupledLaw<fem::IsochoricNeoHookean>>{
          .name = "decoupled, averaged volume",
          .law = {.isochoric = {.mu_mpa = 1.0},
                  .volume = {.form = fem::VolumetricForm::kQuadratic, .kappa_mpa = kKappa_mpa}},
          .waves = Waves(true),
          .shapes = kAveragedShapes,
          .orders = averaged_orders,
          .comparison = Comparison::kAtLeast,
          .reason =
              "at least those of displacement and pressure, less 0.2 on the meshes of a test; "
              "2 and 1.5 for quadratic shapes, by the nodal quadrature of the pressure",
          .max_cells = 8},
      cells, section, progress);
  return section;
}

}  // namespace lefort::verify
