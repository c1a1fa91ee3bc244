#include <lefort/verify/cases.h>
#include <lefort/verify/cook_membrane.h>
#include <lefort/verify/refinement.h>
#include <lefort/verify/shapes.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace lefort::verify {
namespace {

using fem::VolumetricIntegration;

/// Mesh and error of the criterion for locking.
constexpr int kRequiredCells = 32;
constexpr double kRequiredError = 0.02;

/// In the clamped corner of 108 degrees the displacement of an incompressible body varies as the
/// distance to the power 0.544, the root of sin^2(1.893 x) = 1 - x^2 sin^2(1.893)
/// (\cite williams1952); the rise of the tip as twice that power, for all elements.
constexpr double kCornerOrder = 2.0 * 0.544;

/// Of the reference: the error of its finest mesh is 2e-5, its digits end at 7e-5.
constexpr double kUncertainty = 1e-4;

/// Rise of the tip over the reference on each mesh; NaN without a solution.
struct Rises {
  std::vector<int> cells;
  std::vector<double> over_reference;
  std::string failure;
};

Rises rises(mesh::ElementShape shape, const std::vector<int>& cells, Diagonal diagonal,
            VolumetricIntegration volumetric_integration, Progress& progress) {
  Rises found{.cells = cells, .over_reference = {}, .failure = ""};
  for (const int n : cells) {
    const auto tip = solve_cook_membrane(make_cook_membrane(shape, n, diagonal), cook_material(),
                                         volumetric_integration, progress);
    if (!tip) found.failure = tip.error().message;
    found.over_reference.push_back(tip ? tip->y() / kCookTipRise_mm : NAN);
  }
  return found;
}

/// Checks the error for 32 cells, the order and the limit of a shape on meshes that halve.
void check_rises(const std::string& name, const Rises& found, Section& section) {
  const int finest = found.cells.back();
  if (!found.failure.empty()) {
    section.checks.push_back(not_measured(name, found.failure));
    return;
  }
  const auto& values = found.over_reference;
  const std::size_t n = values.size();
  const double error = std::abs(values[n - 1] - 1.0);
  const double order = std::log2(std::abs(values[n - 2] - 1.0) / error);
  const double coarser = double(kRequiredCells) / finest;
  section.checks.push_back(
      {.name = finest == kRequiredCells
                   ? fmt::format("{}: error with {} cells per side", name, kRequiredCells)
                   : fmt::format("{}: error that the measured order predicts for {} cells per side",
                                 name, kRequiredCells),
       .measured = error / std::pow(coarser, order),
       .comparison = Comparison::kAtMost,
       .tolerance = kRequiredError,
       .reason =
           "requirement for the locking remedy of every shape on such a mesh; locking gives 30 %"});
  if (error > 2.0 * kUncertainty)  // Otherwise it has converged and shows no order.
    section.checks.push_back({.name = fmt::format("{}: order", name),
                              .measured = order,
                              .comparison = Comparison::kAtLeast,
                              .expected = kCornerOrder,
                              .tolerance = 0.2,
                              .reason = "twice the exponent of the clamped corner; on coarse "
                                        "meshes the 2 of the smooth part may appear"});
  const Refinement refinement =
      refinement_of({values[n - 3], values[n - 2], values[n - 1]}, kCornerOrder);
  section.checks.push_back(
      {.name = fmt::format("{}: difference from the reference over the predicted one", name),
       .measured = error / (refinement.error + kUncertainty),
       .comparison = Comparison::kAtMost,
       .tolerance = 1.0,
       .reason = "the error that the last three meshes predict, times Roache's 1.25, plus 1e-4 of "
                 "the reference"});
}

/// The meshes of the report.
constexpr std::array kColumns{2, 4, 8, 16, 32};

std::vector<std::string> row_of(mesh::ElementShape shape, const char* what, const Rises& found) {
  std::vector<std::string> row{text_of(shape), what};
  for (const int n : kColumns) {
    const auto at = std::ranges::find(found.cells, n);
    const double rise =
        at == found.cells.end() ? NAN : found.over_reference[std::size_t(at - found.cells.begin())];
    row.push_back(std::isnan(rise) ? "" : fmt::format("{:+.2f} %", 100.0 * (rise - 1.0)));
  }
  return row;
}

report::PlotLine line_of(mesh::ElementShape shape, const Rises& found) {
  report::PlotLine line{.name = text_of(shape)};
  for (std::size_t n = 0; n < found.cells.size(); ++n) {
    line.x.push_back(std::log2(found.cells[n]));
    line.y.push_back(100.0 * (found.over_reference[n] - 1.0));
  }
  return line;
}

/// Without a remedy the same meshes must lock; otherwise the case would show nothing.
void check_locked(mesh::ElementShape shape, const Rises& found, Section& section) {
  section.checks.push_back(
      {.name = fmt::format("{}, volume at the points, {} cells: rise over reference",
                           text_of(shape), found.cells.back()),
       .measured = found.over_reference.back(),
       .comparison = Comparison::kAtMost,
       .expected = 0.7,
       .reason = "this problem must distinguish elements that lock: the rise of linear shapes is "
                 "too small by a third and more"});
}

bool is_cut(mesh::ElementShape shape) {
  using enum mesh::ElementShape;
  return shape != kHex8 && shape != kHex20 && shape != kPyramid5;
}

}  // namespace

Section verify_cook(Extent extent, Progress& progress) {
  const bool full = extent == Extent::kFull;
  Section section{
      .name = "cook",
      .title = "No locking: Cook's membrane",
      .text = fmt::format(
          "A tapered panel, 48 mm long, 44 mm high where it is clamped and 16 mm at its end "
          "(Cook, Improved two-dimensional finite element, J. Struct. Div. ASCE 1974), in plane "
          "strain: one layer of elements, fixed across it. nu = 0.4999, bulk modulus 5000 times "
          "the shear modulus, decoupled neo-Hookean law (Simo and Armero 1992); a dead load of "
          "6.25 MPa on the end shears it at finite strain. The report has the relative error of "
          "the rise of the upper corner of the end, with volumetric averaging (the method of "
          "each shape) and with full integration. The reference, {} mm, comes from a different "
          "program: Taylor-Hood elements, 6.90927, 6.92736, 6.93111 and 6.93187 mm on 4, 8, 16 "
          "and 32 cells. Cells are divided along their shorter diagonal; in the full form also "
          "along the longer one, which makes slender elements.",
          kCookTipRise_mm)};
  Table table{.title = "Error of the rise, by cells per side", .header = {"shape", "volume"}};
  for (const int n : kColumns) table.header.push_back(fmt::format("{0} x {0}", n));
  report::LinePlot plot{.title = "Cook's membrane: error of the corner's rise",
                        .x_label = "refinement: log2 of the cells along a side",
                        .y_label = "error of the rise [%]"};
  double done = 0.0;
  for (const mesh::ElementShape shape : kAllShapes) {
    const bool is_linear = degree(shape) == 1;
    const std::vector<int> short_series{4, 8, 16};
    const std::vector<int> cells = full ? std::vector{4, 8, 16, 32} : short_series;
    if (averages_volume(shape)) {
      const Rises averaged =
          rises(shape, cells, Diagonal::kShorter, VolumetricIntegration::kMeanDilatation, progress);
      table.rows.push_back(row_of(shape, "averaged", averaged));
      plot.lines.push_back(line_of(shape, averaged));
      check_rises(text_of(shape), averaged, section);
    }
    if (full && averages_volume(shape) && is_cut(shape)) {
      const Rises slender = rises(shape, short_series, Diagonal::kLonger,
                                  VolumetricIntegration::kMeanDilatation, progress);
      table.rows.push_back(row_of(shape, "averaged, longer diagonal", slender));
      check_rises(fmt::format("{}, longer diagonal", text_of(shape)), slender, section);
    }
    if (full || is_linear) {
      const Rises locked =
          rises(shape,
                !full       ? std::vector{8}
                : is_linear ? cells
                            : short_series,
                Diagonal::kShorter, VolumetricIntegration::kFullIntegration, progress);
      table.rows.push_back(row_of(shape, "at points", locked));
      if (is_linear) check_locked(shape, locked, section);
    }
    progress.report(++done / double(kAllShapes.size()));
  }
  section.tables.push_back(std::move(table));
  section.plots.push_back(std::move(plot));
  return section;
}

}  // namespace lefort::verify
