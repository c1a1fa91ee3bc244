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

/// Where the plate's edge meets the free side the displacement goes with the distance to the power
/// x = 0.595, the root of sin^2(pi x / 2) = 1 - x^2 for an incompressible body (\cite
/// williams1952). Strains come with order 1 where cells are graded with a power g > 1 / x of the
/// distance (\cite babuska1979), displacements in the L2 norm with twice that.
constexpr double kBulgeGrading = 2.5;
constexpr double kOrder = 2.0;

/// How far the cube is flattened, and what is known of the outcome: numbers in the middle of what
/// seven shapes tend to on the meshes of the full form, which the report tells.
struct Load {
  const char* name;
  double compression;
  double force_n;      ///< On the plate, of the eighth.
  double bulge_mm;     ///< How far the middle of a side moves out.
  double uncertainty;  ///< Of both, as a share.
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

/// An eighth of the cube between plates it sticks to.
///
/// \param corners  where to tell the displacement: corners of cells.
Result<Outcome> compress(mesh::ElementShape shape, int cells, const Load& load,
                         std::span<const Vec3> corners, Progress& progress) {
  const double kappa_mpa =
      2.0 * kBulgeMu_mpa * (1.0 + kBulgePoisson) / (3.0 * (1.0 - 2.0 * kBulgePoisson));
  CaseModel model{.mesh = graded_cube(shape, cells, kHalf_mm, kBulgeGrading),
                  .materials = {{0, split_neo_hookean(kBulgeMu_mpa, kappa_mpa)}},
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
  hold(top, 2, -load.compression * kHalf_mm, prescribed);
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

/// The corners of a mesh of so many cells a side, and to each its share of the volume (by the
/// trapezoidal rule): what sums of squares need to be L2 norms.
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

/// The L2 norm of what one mesh's displacement differs from the next one's.
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

/// Three values, coarse to fine, over the reference.
using Ratios = std::array<double, 3>;

/// What they tend to by an order, and by how much that may be wrong.
std::string limit_of(const Ratios& values, double order) {
  const double p = std::min(order, kOrder);
  return fmt::format("{:.4f} ± {:.4f}", values[2] + (values[2] - values[1]) / (std::exp2(p) - 1.0),
                     predicted_error(values, p));
}

void press(const Load& load, Extent extent, Section& section, Progress& progress) {
  Table table{
      .title = fmt::format("Flattened by {}: force and bulge on three meshes that halve, over "
                           "the reference; the order of the displacement; what force and "
                           "bulge tend to by that order",
                           load.name),
      .header = {"shape", "finest", "force", "", "", "bulge", "", "", "order", "force", "bulge"}};
  report::LinePlot plot{
      .title = fmt::format("Block flattened by {}: force over the reference", load.name),
      .x_label = "refinement: log2 of the cells along a side",
      .y_label = "force over reference"};
  for (const mesh::ElementShape shape : kAllShapes) {
    const std::string name = fmt::format("{}, {}", load.name, text_of(shape));
    const std::vector<int> cells = meshes(shape, extent);
    const Corners corners = corners_of(cells.front());
    std::vector<Outcome> outcomes;
    report::PlotLine line{.name = text_of(shape)};
    std::string failure;
    for (const int n : cells) {
      const auto found = compress(shape, n, load, corners.at, progress);
      if (!found) failure = found.error().message;
      if (!found) break;
      outcomes.push_back(*found);
      line.x.push_back(std::log2(n));
      line.y.push_back(found->force_n / load.force_n);
    }
    plot.lines.push_back(std::move(line));
    if (!failure.empty()) {
      section.checks.push_back(not_measured(name, failure));
      continue;
    }
    Ratios force{}, bulge{};
    for (std::size_t k = 0; k < 3; ++k) {
      force[k] = outcomes[k].force_n / load.force_n;
      bulge[k] = outcomes[k].bulge_mm / load.bulge_mm;
    }
    const double order = std::log2(difference(outcomes[0], outcomes[1], corners) /
                                   difference(outcomes[1], outcomes[2], corners));
    std::vector<std::string> row{text_of(shape), fmt::format("{}", cells.back())};
    for (const double value : force) row.push_back(fmt::format("{:.4f}", value));
    for (const double value : bulge) row.push_back(fmt::format("{:.4f}", value));
    row.insert(row.end(),
               {fmt::format("{:.2f}", order), limit_of(force, order), limit_of(bulge, order)});
    table.rows.push_back(std::move(row));

    section.checks.push_back({.name = fmt::format("{}: displacement: order", name),
                              .measured = order,
                              .comparison = Comparison::kAtLeast,
                              .expected = kOrder,
                              .tolerance = 0.2,
                              .reason = "cells graded towards the singular edges: twice the order "
                                        "of strains"});
    const Known known{.order = kOrder,
                      .allowance = load.uncertainty,
                      .allowance_reason = "the reference is not known better"};
    check_difference(fmt::format("{}: force", name), force, order, known, section);
    check_difference(fmt::format("{}: bulge", name), bulge, order, known, section);
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
          "A cube of 2 mm (an eighth is meshed), nu = {}, is flattened between plates it sticks "
          "to; "
          "its sides bulge. Nothing closed is known; told are the force on a plate and how far the "
          "middle of a side comes out, over {:.6f} N and {:.6f} mm at {}, {:.5f} N and {:.5f} mm "
          "at "
          "{}, where seven shapes meet: the columns of limits tell how closely. Stress is singular "
          "at the plates' edges, where the displacement of an incompressible body goes with the "
          "distance to the power 0.595 (Williams 1952): on regular meshes no order above 1.19 is "
          "to "
          "be had. So cells are graded with the power {} of the distance to the edges, with which "
          "strains come with order 1 (Babuska, Kellogg and Pitkaranta 1979). Force and bulge, in "
          "which errors of both signs meet, may be right by chance; the order is that of the "
          "displacement in the L2 norm, taken between one mesh and the next at the corners that "
          "all "
          "three share. It is 2 for every shape, hex20 with its linear pressure being welcome to "
          "more.",
          kBulgePoisson, kLoads[0].force_n, kLoads[0].bulge_mm, kLoads[0].name, kLoads[1].force_n,
          kLoads[1].bulge_mm, kLoads[1].name, kBulgeGrading)};
  const auto loads = std::span(kLoads).first(extent == Extent::kFull ? kLoads.size() : 1);
  double done = 0.0;
  for (const Load& load : loads) {
    press(load, extent, section, progress);
    progress.report(++done / double(loads.size()));
  }
  return section;
}

}  // namespace lefort::verify
