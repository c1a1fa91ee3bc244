#include <lefort/mesh/box_grid.h>
#include <lefort/verify/case_model.h>
#include <lefort/verify/cases.h>
#include <lefort/verify/check_convergence_order.h>
#include <lefort/verify/shapes.h>

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace lefort::verify {
namespace {

constexpr double kBeamLength_mm = 10.0;
constexpr double kSide_mm = 1.0;
constexpr double kYoung_mpa = 1.0;
constexpr double kBeamPoisson = 0.3;
/// The tip moves by a hundredth of the length, so that second-order effects are negligible.
constexpr double kForce_n = 2.5e-5;

/// At the edges of the clamped end, of 90 degrees, the displacement varies as the distance to the
/// power 0.71, the root of sin^2(pi x / 2) = (4 (1 - nu)^2 - x^2) / (3 - 4 nu); the deflection
/// with twice that (\cite williams1952).
constexpr double kEdgeOrder = 2.0 * 0.71;

/// Timoshenko's beam: F L^3 / (3 E I) + F L / (k G A), Cowper's k for a rectangle.
double beam_deflection() {
  const double inertia = std::pow(kSide_mm, 4) / 12.0;
  const double k = 10.0 * (1.0 + kBeamPoisson) / (12.0 + 11.0 * kBeamPoisson);
  const double shear_mpa = kYoung_mpa / (2.0 * (1.0 + kBeamPoisson));
  return kForce_n * std::pow(kBeamLength_mm, 3) / (3.0 * kYoung_mpa * inertia) +
         kForce_n * kBeamLength_mm / (k * shear_mpa * kSide_mm * kSide_mm);
}

/// Mean deflection of the free end [mm], with `cells` over the height.
Result<double> deflection(mesh::ElementShape shape, int cells, Progress& progress) {
  const double shear_mpa = kYoung_mpa / (2.0 * (1.0 + kBeamPoisson));
  const double kappa_mpa = kYoung_mpa / (3.0 * (1.0 - 2.0 * kBeamPoisson));
  CaseModel model{.mesh = mesh::make_box(shape, {5 * cells, cells, cells},
                                         {kBeamLength_mm, kSide_mm, kSide_mm}),
                  .materials = {{0, decoupled_neo_hookean(shear_mpa, kappa_mpa)}},
                  .prescribed = {}};
  std::vector<fem::PrescribedDisplacement> prescribed;
  for (int c = 0; c < 3; ++c) prescribe(model.mesh.node_sets.at("x0"), c, 0.0, prescribed);
  model.prescribed = in_proportion(std::move(prescribed));
  LEFORT_TRY(model.forces, fem::traction_forces(model.mesh.nodes_L, model.mesh.face_sets.at("x1"),
                                                {0.0, 0.0, kForce_n / (kSide_mm * kSide_mm)}));
  LEFORT_TRY(const Equilibrium found, solve(model, {.relative_tolerance = 1e-7}, progress));
  double work = 0.0;
  for (const fem::NodalForce& force : model.forces)
    work += force.force_n.dot(found.u.segment<3>(3 * Index(force.node)));
  return work / kForce_n;
}

constexpr std::array kBeamColumns{1, 2, 4, 8};

/// Stiffness over the beam's, coarse to fine.
struct BeamStiffness {
  std::vector<double> values = {};
  double single_layer = NAN;  ///< Of quadratic shapes in the full form.
  std::string failure = "";
};

BeamStiffness bend_all(mesh::ElementShape shape, Extent extent, Table& table,
                       report::LinePlot& plot, Progress& progress) {
  // A single layer of the other shapes does not show how finer meshes converge.
  using enum mesh::ElementShape;
  const bool full = extent == Extent::kFull;
  const bool is_fine = full || shape == kHex8 || shape == kWedge6 || degree(shape) == 2;
  const double wanted = beam_deflection();
  std::vector<std::string> row{text_of(shape)};
  report::PlotLine line{.name = text_of(shape)};
  BeamStiffness stiffness;
  for (const int n : kBeamColumns) {
    const bool is_single = n == 1 && full && degree(shape) == 2;
    if (n == (is_fine ? 1 : 8) && !is_single) {
      row.emplace_back("");
      continue;
    }
    const auto found = deflection(shape, n, progress);
    if (!found) stiffness.failure = found.error().message;
    const double ratio = found ? *found / wanted : NAN;
    if (is_single) stiffness.single_layer = 1.0 / ratio;
    stiffness.values.push_back(1.0 / ratio);
    row.push_back(fmt::format("{:.4f}", ratio));
    line.x.push_back(std::log2(n));
    line.y.push_back(ratio);
  }
  table.rows.push_back(std::move(row));
  plot.lines.push_back(std::move(line));
  return stiffness;
}

void check_stiffness(mesh::ElementShape shape, Extent extent, const BeamStiffness& stiffness,
                     Section& section) {
  const std::string name = text_of(shape);
  if (!stiffness.failure.empty()) {
    section.checks.push_back(not_measured(name, stiffness.failure));
    return;
  }
  if (extent == Extent::kFull && degree(shape) == 2)
    section.checks.push_back({.name = fmt::format("{}: stiffness of one layer", name),
                              .measured = stiffness.single_layer,
                              .expected = 1.0,
                              .tolerance = 0.1,
                              .reason = "displacements of degree 2 contain those of a bent beam; "
                                        "the rest is the clamped end and the element's own shear"});
  const bool is_hex20 = shape == mesh::ElementShape::kHex20;
  check_convergence_order(
      fmt::format("{}: stiffness over the beam's", name), stiffness.values,
      {.order = is_hex20 ? kEdgeOrder : 2.0,
       .order_slack = 0.2,
       .order_reason = is_hex20 ? "the remaining error is at the clamped end, whose edges are "
                                  "singular"
                                : "shear and volume ratio are correct to first order in an "
                                  "element, their energy to second",
       .allowance = kSide_mm * kSide_mm / (kBeamLength_mm * kBeamLength_mm),
       .allowance_reason = "beam theory neglects the ends: (height / length)^2"},
      section);
}

Section bending_section() {
  return {.name = "bending",
          .title = "Slender cantilever against Timoshenko's beam",
          .text = fmt::format(
              "A beam of {} x {} x {} mm, E = {} MPa, nu = {}, decoupled law, with a small dead "
              "load across its free end. Expected: F L^3 / (3 E I) + F L / (k G A) with k = 10 (1 "
              "+ nu) / (12 + 11 nu) (Cowper, The shear coefficient in Timoshenko's beam theory, "
              "J. Appl. Mech. 1966). Cells are twice as long as high. Linear shapes are known to "
              "be too stiff in bending; this error must decrease with the square of the cell "
              "size. For quadratic shapes, the error of a single layer must be at most a tenth.",
              kBeamLength_mm, kSide_mm, kSide_mm, kYoung_mpa, kBeamPoisson)};
}

}  // namespace

Section verify_bending(Extent extent, Progress& progress) {
  Section section = bending_section();
  Table table{.title = "Deflection of the end over the beam's, by cells over the height",
              .header = {"shape"}};
  for (const int n : kBeamColumns) table.header.push_back(fmt::format("{}", n));
  report::LinePlot plot{.title = "Cantilever: deflection over the beam's",
                        .x_label = "refinement: log2 of the cells over the height",
                        .y_label = "deflection over beam's"};
  for (const mesh::ElementShape shape : kAllShapes)
    check_stiffness(shape, extent, bend_all(shape, extent, table, plot, progress), section);
  section.tables.push_back(std::move(table));
  section.plots.push_back(std::move(plot));
  return section;
}

}  // namespace lefort::verify
