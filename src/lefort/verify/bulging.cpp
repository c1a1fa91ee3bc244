#include <lefort/verify/case_model.h>
#include <lefort/verify/cases.h>
#include <lefort/verify/check_convergence_order.h>
#include <lefort/verify/mapped_mesh.h>
#include <lefort/verify/refinement.h>
#include <lefort/verify/shapes.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace lefort::verify {
namespace {

constexpr double kHalf_mm = 1.0;
constexpr double kBulgeMu_mpa = 1.0;
constexpr double kBulgePoisson = 0.499;

/// At the edge between plate and free side the displacement varies as the distance to the power
/// x = 0.595, the root of sin^2(pi x / 2) = 1 - x^2 for an incompressible body (\cite
/// williams1952). Strains have order 1 if cells are graded with a power g > 1 / x of the
/// distance (\cite babuska1979), displacements in the L2 norm with twice that.
constexpr double kBulgeGrading = 2.5;
constexpr double kOrder = 2.0;

/// A compression and its reference: the middle of the limits of seven shapes with one pressure per
/// element.
struct Load {
  const char* name;
  double compression;
  double force_n;      ///< On the plate, of the eighth.
  double bulge_mm;     ///< Outward displacement of the center of a side.
  double uncertainty;  ///< Of both, relative.
};
constexpr std::array kLoads{Load{.name = "1 %",
                                 .compression = 0.01,
                                 .force_n = 0.037304,
                                 .bulge_mm = 0.006575,
                                 .uncertainty = 0.0005},
                            Load{.name = "5 %",
                                 .compression = 0.05,
                                 .force_n = 0.19435,
                                 .bulge_mm = 0.0340,
                                 .uncertainty = 0.001}};

struct Outcome {
  double force_n = 0.0;
  double bulge_mm = 0.0;
  std::vector<Vec3> u_mm = {};  ///< At the corners of the coarsest mesh's cells.
};

/// Compresses an eighth of the cube between plates to which it sticks.
///
/// \param corners  of cells: points of Outcome::u_mm.
Result<Outcome> compress(mesh::ElementShape shape, int cells, const Load& load,
                         std::span<const Vec3> corners, Progress& progress) {
  const double kappa_mpa =
      2.0 * kBulgeMu_mpa * (1.0 + kBulgePoisson) / (3.0 * (1.0 - 2.0 * kBulgePoisson));
  CaseModel model{.mesh = graded_cube(shape, cells, kHalf_mm, kBulgeGrading),
                  .materials = {{0, decoupled_neo_hookean(kBulgeMu_mpa, kappa_mpa)}},
                  .prescribed = {}};
  const auto& sets = model.mesh.node_sets;
  const auto top = sets.at("z1");
  std::vector<fem::PrescribedDisplacement> prescribed;
  const auto prescribe_below_top = [&](const char* side, int axis) {
    for (const std::int32_t node : sets.at(side))
      if (model.mesh.nodes_L[std::size_t(node)].z() < kHalf_mm - 1e-9)
        prescribe({node}, axis, 0.0, prescribed);
  };
  prescribe_below_top("x0", 0);
  prescribe_below_top("y0", 1);
  prescribe(sets.at("z0"), 2, 0.0, prescribed);
  prescribe(top, 0, 0.0, prescribed);
  prescribe(top, 1, 0.0, prescribed);
  prescribe(top, 2, -load.compression * kHalf_mm, prescribed);
  model.prescribed = in_proportion(std::move(prescribed));
  LEFORT_TRY(const Equilibrium found, solve(model, {.relative_tolerance = 1e-9}, progress));
  const auto u_at = [&](const Vec3& corner) -> Vec3 {
    const auto there =
        nodes_where(model.mesh, [&](const Vec3& p) { return (p - corner).norm() < 1e-9; });
    return found.u.segment<3>(3 * Index(there.at(0)));
  };
  Outcome outcome{.force_n = -sum_over(top, found.reaction_n).z(),
                  .bulge_mm = u_at({kHalf_mm, 0.0, 0.0}).x()};
  for (const Vec3& corner : corners) outcome.u_mm.push_back(u_at(corner));
  return outcome;
}

/// Corners of a mesh with `cells` per side, and the volume of each by the trapezoidal rule: weights
/// of an L2 norm.
struct Corners {
  std::vector<Vec3> at;
  std::vector<double> volume_mm3;
};

Corners corners_of(int cells) {
  const auto x = [&](int i) { return kHalf_mm * graded_corner(i, cells, kBulgeGrading); };
  const auto width = [&](int i) {
    return 0.5 * (x(std::min(i + 1, cells)) - x(std::max(i - 1, 0)));
  };
  Corners corners;
  for (int i = 0; i <= cells; ++i)
    for (int j = 0; j <= cells; ++j)
      for (int k = 0; k <= cells; ++k) {
        corners.at.emplace_back(x(i), x(j), x(k));
        corners.volume_mm3.push_back(width(i) * width(j) * width(k));
      }
  return corners;
}

/// L2 norm of the difference between the displacements on two meshes.
double difference(const Outcome& a, const Outcome& b, const Corners& corners) {
  double sum = 0.0;
  for (std::size_t c = 0; c < corners.at.size(); ++c)
    sum += corners.volume_mm3[c] * (a.u_mm[c] - b.u_mm[c]).squaredNorm();
  return std::sqrt(sum);
}

std::vector<int> meshes(mesh::ElementShape shape, Extent extent) {
  return extent == Extent::kFull && degree(shape) == 1 ? std::vector{4, 8, 16}
                                                       : std::vector{2, 4, 8};
}

/// Three values over the reference, coarse to fine.
using Ratios = std::array<double, 3>;

/// Their limit by an order, and its uncertainty.
std::string limit_of(const Ratios& values, double order) {
  const double p = std::min(order, kOrder);
  return fmt::format("{:.4f} ± {:.4f}", values[2] + (values[2] - values[1]) / (std::exp2(p) - 1.0),
                     predicted_error(values, p));
}

/// Force and bulge of one shape over the reference, and the order of the displacement.
struct BulgeRatios {
  Ratios force{}, bulge{};
  double order = NAN;
  std::string failure = "";
};

BulgeRatios compress_all(mesh::ElementShape shape, const std::vector<int>& cells, const Load& load,
                         report::PlotLine& line, Progress& progress) {
  const Corners corners = corners_of(cells.front());
  std::vector<Outcome> outcomes;
  BulgeRatios ratios;
  for (const int n : cells) {
    const auto found = compress(shape, n, load, corners.at, progress);
    if (!found) {
      ratios.failure = found.error().message;
      return ratios;
    }
    outcomes.push_back(*found);
    line.x.push_back(std::log2(n));
    line.y.push_back(found->force_n / load.force_n);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    ratios.force[k] = outcomes[k].force_n / load.force_n;
    ratios.bulge[k] = outcomes[k].bulge_mm / load.bulge_mm;
  }
  ratios.order = std::log2(difference(outcomes[0], outcomes[1], corners) /
                           difference(outcomes[1], outcomes[2], corners));
  return ratios;
}

std::vector<std::string> bulge_row(mesh::ElementShape shape, int finest,
                                   const BulgeRatios& ratios) {
  std::vector<std::string> row{text_of(shape), fmt::format("{}", finest)};
  for (const double value : ratios.force) row.push_back(fmt::format("{:.4f}", value));
  for (const double value : ratios.bulge) row.push_back(fmt::format("{:.4f}", value));
  row.insert(row.end(), {fmt::format("{:.2f}", ratios.order), limit_of(ratios.force, ratios.order),
                         limit_of(ratios.bulge, ratios.order)});
  return row;
}

void check_bulge(const std::string& name, const Load& load, const BulgeRatios& ratios,
                 Section& section) {
  section.checks.push_back({.name = fmt::format("{}: displacement: order", name),
                            .measured = ratios.order,
                            .comparison = Comparison::kAtLeast,
                            .expected = kOrder,
                            .tolerance = 0.2,
                            .reason = "cells graded towards the singular edges: twice the order "
                                      "of strains"});
  const Known known{.order = kOrder,
                    .allowance = load.uncertainty,
                    .allowance_reason = "the reference is not known better"};
  check_difference(fmt::format("{}: force", name), ratios.force, ratios.order, known, section);
  check_difference(fmt::format("{}: bulge", name), ratios.bulge, ratios.order, known, section);
}

/// All shapes at one compression.
void run_load(const Load& load, Extent extent, Section& section, Progress& progress) {
  Table table{
      .title = fmt::format("Compressed by {}: force and bulge on three meshes that halve, over "
                           "the reference; the order of the displacement; the limits of force and "
                           "bulge by that order",
                           load.name),
      .header = {"shape", "finest", "force", "", "", "bulge", "", "", "order", "force", "bulge"}};
  report::LinePlot plot{
      .title = fmt::format("Block compressed by {}: force over the reference", load.name),
      .x_label = "refinement: log2 of the cells along a side",
      .y_label = "force over reference"};
  for (const mesh::ElementShape shape : kAveragedShapes) {
    const std::string name = fmt::format("{}, {}", load.name, text_of(shape));
    const std::vector<int> cells = meshes(shape, extent);
    report::PlotLine line{.name = text_of(shape)};
    const BulgeRatios ratios = compress_all(shape, cells, load, line, progress);
    plot.lines.push_back(std::move(line));
    if (!ratios.failure.empty()) {
      section.checks.push_back(not_measured(name, ratios.failure));
      continue;
    }
    table.rows.push_back(bulge_row(shape, cells.back(), ratios));
    check_bulge(name, load, ratios, section);
  }
  section.tables.push_back(std::move(table));
  section.plots.push_back(std::move(plot));
}

}  // namespace

Section verify_bulging(Extent extent, Progress& progress) {
  Section section{
      .name = "bulging",
      .title = "Nearly incompressible block between sticking plates",
      .text = fmt::format(
          "A cube of 2 mm (an eighth is meshed), nu = {}, is compressed between plates to which "
          "it sticks; its sides bulge. There is no closed form. The report has the force on a "
          "plate and the displacement of the center of a side, over {:.6f} N and {:.6f} mm at {}, "
          "{:.5f} N and {:.5f} mm at {}. These are the values on which seven shapes agreed with "
          "one pressure per element; the "
          "columns of limits show how closely. Stress is singular at the edges of the plates, "
          "where the displacement of an incompressible body varies as the distance to the power "
          "0.595 (Williams 1952). On regular meshes the order is therefore at most 1.19. Cells "
          "are graded with the power {} of the distance to the edges, for which the "
          "strains converge with order 1 (Babuska, Kellogg and Pitkaranta 1979). Force and bulge "
          "contain errors of both signs, which may cancel; the order is that of the displacement "
          "in the L2 norm, between one mesh and the next at the corners common to all three. It "
          "must be at least 2 for every shape; hex20 with its linear pressure may have more.",
          kBulgePoisson, kLoads[0].force_n, kLoads[0].bulge_mm, kLoads[0].name, kLoads[1].force_n,
          kLoads[1].bulge_mm, kLoads[1].name, kBulgeGrading)};
  const auto loads = std::span(kLoads).first(extent == Extent::kFull ? kLoads.size() : 1);
  double done = 0.0;
  for (const Load& load : loads) {
    run_load(load, extent, section, progress);
    progress.report(++done / double(loads.size()));
  }
  return section;
}

}  // namespace lefort::verify
