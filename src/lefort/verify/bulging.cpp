#include <lefort/mesh/box_grid.h>
#include <lefort/verify/case_model.h>
#include <lefort/verify/cases.h>
#include <lefort/verify/refinement.h>
#include <lefort/verify/shapes.h>

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace lefort::verify {
namespace {

constexpr double kHalf_mm = 1.0;
constexpr double kCompression = 0.2;
constexpr double kMu_mpa = 1.0;
constexpr double kPoisson = 0.499;

/// To which tet10, wedge15 and, extrapolated, hex8 agree (tests/fem/test_compressed_block.cpp), and
/// how well they do.
constexpr double kForce_n = 0.9075;
constexpr double kBulge_mm = 0.1534;
constexpr double kUncertainty = 0.001;

/// Where the plate's edge meets the free side the displacement goes with the distance to the power
/// 0.595, the root of sin^2(pi x / 2) = 1 - x^2 for an incompressible body (\cite williams1952).
/// Force and bulge go with twice that in a stable mixed method. What three meshes predict is taken
/// from the order they measure, at most that of the displacement.
constexpr double kEdgeExponent = 0.595;
constexpr double kEdgeOrder = 2.0 * kEdgeExponent;

struct Bulge {
  double force_n = 0.0;   ///< On the plate, of the eighth.
  double bulge_mm = 0.0;  ///< How far the middle of a side moves out.
};

/// An eighth of the cube between plates it sticks to.
Result<Bulge> compress(mesh::ElementShape shape, int cells, Progress& progress) {
  const double kappa_mpa = 2.0 * kMu_mpa * (1.0 + kPoisson) / (3.0 * (1.0 - 2.0 * kPoisson));
  CaseModel model{.mesh = mesh::make_box(shape, {cells, cells, cells}, Vec3::Constant(kHalf_mm)),
                  .materials = {{0, split_neo_hookean(kMu_mpa, kappa_mpa)}},
                  .prescribed = {}};
  const auto& sets = model.mesh.node_sets;
  const auto top = sets.at("z1");
  std::vector<fem::PrescribedDisplacement> prescribed;
  const auto hold_off_top = [&](const char* side, int axis) {
    for (const std::int32_t node : sets.at(side))
      if (model.mesh.nodes_L[std::size_t(node)].z() < kHalf_mm - 1e-9)
        hold({node}, axis, 0.0, prescribed);
  };
  hold_off_top("x0", 0);
  hold_off_top("y0", 1);
  hold(sets.at("z0"), 2, 0.0, prescribed);
  hold(top, 0, 0.0, prescribed);
  hold(top, 1, 0.0, prescribed);
  hold(top, 2, -kCompression * kHalf_mm, prescribed);
  model.prescribed = in_proportion(std::move(prescribed));
  LEFORT_TRY(const Equilibrium found,
             solve(model, {.increments = 2, .relative_tolerance = 1e-9}, progress));
  const auto middle = nodes_where(
      model.mesh, [](const Vec3& p) { return (p - Vec3(kHalf_mm, 0.0, 0.0)).norm() < 1e-9; });
  return Bulge{.force_n = -sum_over(top, found.reaction_n).z(),
               .bulge_mm = found.u[3 * Index(middle.at(0))]};
}

std::vector<int> meshes(mesh::ElementShape shape, Extent extent) {
  if (extent == Extent::kFull)
    return degree(shape) == 1 ? std::vector{4, 8, 16} : std::vector{2, 4, 8};
  return degree(shape) == 1 ? std::vector{2, 4, 8} : std::vector{1, 2, 4};
}

/// \param values  over the reference, coarse to fine.
/// \param miss    Why these meshes are known to predict no error; or empty.
void judge(const std::string& name, const std::vector<double>& values, const std::string& miss,
           Section& section) {
  const double error = std::abs(values[2] - 1.0);
  const double predicted = refinement_of({values[0], values[1], values[2]}, kEdgeExponent).error;
  section.checks.push_back(
      {.name = fmt::format("{}: difference over the predicted one", name),
       .measured = error / (predicted + kUncertainty),
       .asked = Asked::kAtMost,
       .expected = 1.0,
       .reason = "the error that three meshes predict, times Roache's 1.25, and 0.1 % of the "
                 "reference's own",
       .miss = miss});
  if (error < 2.0 * kUncertainty) return;  // It has arrived: no order is left.
  section.checks.push_back({.name = fmt::format("{}: order of the error", name),
                            .measured = std::log2(std::abs(values[1] - 1.0) / error),
                            .asked = Asked::kAtLeast,
                            .expected = kEdgeOrder,
                            .tolerance = 0.2,
                            .reason = "twice the exponent of the plates' edges",
                            .miss = "pressures that oscillate beside the singular edges, as those "
                                    "of one value per element or node do, hold the order down"});
}

}  // namespace

Section verify_bulging(Extent extent, Progress& progress) {
  Section section{
      .name = "bulging",
      .title = "Nearly incompressible block between sticking plates",
      .text = fmt::format(
          "A cube of 2 mm (an eighth is meshed), nu = {}, is compressed by {:.0f} % between plates "
          "it sticks to; its sides bulge. Nothing closed is known; told are the force on a plate "
          "and how far the middle of a side comes out, over {} N and {} mm, to which tet10, "
          "wedge15 and, extrapolated, hex8 agree. Stress is singular at the plates' edges, so that "
          "the order is 1.19 at best.",
          kPoisson, 100.0 * kCompression, kForce_n, kBulge_mm)};
  Table table{.title = "Force and bulge over the reference",
              .header = {"shape", "cells a side", "force", "bulge"}};
  report::LinePlot plot{.title = "Block between plates: force over the reference",
                        .x_label = "refinement: log2 of the cells along a side",
                        .y_label = "force over reference"};
  double done = 0.0;
  for (const mesh::ElementShape shape : kAllShapes) {
    const bool is_hex20 = shape == mesh::ElementShape::kHex20;
    if (is_hex20 && extent == Extent::kShort) continue;  // Its coarsest mesh is one element.
    std::vector<double> forces;
    std::vector<double> bulges;
    report::PlotLine line{.name = text_of(shape)};
    std::string failure;
    for (const int n : meshes(shape, extent)) {
      const auto found = compress(shape, n, progress);
      if (!found) failure = found.error().message;
      if (!found) break;
      forces.push_back(found->force_n / kForce_n);
      bulges.push_back(found->bulge_mm / kBulge_mm);
      line.x.push_back(std::log2(n));
      line.y.push_back(forces.back());
      table.rows.push_back({text_of(shape), fmt::format("{}", n),
                            fmt::format("{:.4f}", forces.back()),
                            fmt::format("{:.4f}", bulges.back())});
    }
    progress.report(++done / double(kAllShapes.size()));
    plot.lines.push_back(std::move(line));
    if (!failure.empty()) {
      section.checks.push_back(not_measured(text_of(shape), failure));
      continue;
    }
    judge(fmt::format("{}: force", text_of(shape)), forces, "", section);
    judge(fmt::format("{}: bulge", text_of(shape)), bulges,
          degree(shape) == 2 ? "it settles so late that three meshes predict nothing" : "",
          section);
  }
  section.tables.push_back(std::move(table));
  section.plots.push_back(std::move(plot));
  return section;
}

}  // namespace lefort::verify
