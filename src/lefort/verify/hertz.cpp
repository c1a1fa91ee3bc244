#include <lefort/contact/contact_surface.h>
#include <lefort/contact/contact_term.h>
#include <lefort/field/build/build_distance_field.h>
#include <lefort/mesh/box_grid.h>
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
#include <memory>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

namespace lefort::verify {
namespace {

using std::numbers::pi;

constexpr double kHertzRadius_mm = 10.0;
constexpr double kIndentation_mm = 0.1;
constexpr double kHertzMu_mpa = 1.0;
constexpr double kHertzKappa_mpa = 1000.0;
constexpr double kHertzPoisson =
    (3.0 * kHertzKappa_mpa - 2.0 * kHertzMu_mpa) / (2.0 * (3.0 * kHertzKappa_mpa + kHertzMu_mpa));
/// Side length of the block in contact radii.
constexpr double kFarRadii = 8.0;
/// Penalty stiffness: penetration under Hertz's largest pressure is 0.06 % of the indentation.
constexpr double kHertzStiffness_mpa_per_mm = 2000.0;

double contact_radius_mm() { return std::sqrt(kHertzRadius_mm * kIndentation_mm); }

/// Hertz: 4/3 E* sqrt(R d^3), with E* = E / (1 - nu^2) = 2 mu / (1 - nu) against a rigid sphere.
double hertz_force_n(double indentation_mm) {
  const double plane_mpa = 2.0 * kHertzMu_mpa / (1.0 - kHertzPoisson);
  return 4.0 / 3.0 * plane_mpa * std::sqrt(kHertzRadius_mm * std::pow(indentation_mm, 3));
}

/// Boussinesq: displacement of the half-space z <= 0 under a point force downwards at its origin.
Vec3 boussinesq(const Vec3& p, double force_n) {
  const double depth = -p.z();
  const double rho = p.norm();
  const double r = p.head<2>().norm();
  const double unit = force_n / (4.0 * pi * kHertzMu_mpa);
  const double outwards = unit * (r * depth / std::pow(rho, 3) -
                                  (1.0 - 2.0 * kHertzPoisson) * r / (rho * (rho + depth)));
  const double down = unit * (2.0 * (1.0 - kHertzPoisson) / rho + depth * depth / std::pow(rho, 3));
  const double fraction = r > 0.0 ? outwards / r : 0.0;
  return {fraction * p.x(), fraction * p.y(), -down};
}

/// Position of the n-th corner along a side of the block.
double corner_mm(int n, int cells) {
  constexpr double kHertzGrading = 5.0;
  return kFarRadii * contact_radius_mm() * std::sinh(kHertzGrading * n / cells) /
         std::sinh(kHertzGrading);
}

/// Edge length of the cell at the edge of the contact.
double edge_cell_mm(int cells) {
  int n = 0;
  while (corner_mm(n + 1, cells) < contact_radius_mm()) ++n;
  return corner_mm(n + 1, cells) - corner_mm(n, cells);
}

/// A quarter of a block below z = 0, with small cells around the origin. Cells have straight edges.
mesh::VolumeMesh graded_block(mesh::ElementShape shape, int cells) {
  const auto position = [&](double s) {
    const int cell = std::min(int(std::floor(s * cells + 1e-9)), cells - 1);
    return std::lerp(corner_mm(cell, cells), corner_mm(cell + 1, cells), s * cells - cell);
  };
  return mapped(mesh::make_box(shape, {cells, cells, cells}, Vec3::Ones()), [&](const Vec3& p) {
    return Vec3(position(p.x()), position(p.y()), -position(1.0 - p.z()));
  });
}

/// The lower part of the sphere, with its lowest point at the origin and vertices on the sphere.
geometry::TriangleMesh cap() {
  constexpr int kCells = 100;
  const double half_width_mm = 2.5 * contact_radius_mm();
  geometry::TriangleMesh surface;
  for (int j = 0; j <= kCells; ++j)
    for (int i = 0; i <= kCells; ++i) {
      const double x = half_width_mm * (2.0 * i / kCells - 1.0);
      const double y = half_width_mm * (2.0 * j / kCells - 1.0);
      surface.vertices.emplace_back(
          x, y, kHertzRadius_mm - std::sqrt(kHertzRadius_mm * kHertzRadius_mm - x * x - y * y));
    }
  const auto at = [](int i, int j) { return std::int32_t(j * (kCells + 1) + i); };
  for (int j = 0; j < kCells; ++j)
    for (int i = 0; i < kCells; ++i) {
      surface.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i + 1, j)});
      surface.triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j + 1)});
    }
  return surface;
}

struct Indented {
  double force_n = 0.0;    ///< On the whole sphere.
  double radius_mm = 0.0;  ///< Of contact.
  std::vector<contact::ContactPoint> points = {};
};

Result<Indented> indent(mesh::ElementShape shape, int cells,
                        const std::shared_ptr<const contact::DistanceQuery>& sphere_B,
                        Progress& progress) {
  CaseModel model{.mesh = graded_block(shape, cells),
                  .materials = {{0, decoupled_neo_hookean(kHertzMu_mpa, kHertzKappa_mpa)}},
                  .prescribed = {}};
  const double side_mm = kFarRadii * contact_radius_mm();
  const auto is_far = [&](const Vec3& p) {
    return std::max({p.x(), p.y(), -p.z()}) > side_mm - 1e-9;
  };
  const auto far = nodes_where(model.mesh, is_far);
  std::vector<fem::PrescribedDisplacement> on_symmetry;
  for (int axis = 0; axis < 2; ++axis)
    prescribe(nodes_where(model.mesh,
                          [&](const Vec3& p) { return std::abs(p[axis]) < 1e-9 && !is_far(p); }),
              axis, 0.0, on_symmetry);
  model.prescribed = [&](double fraction) {
    std::vector<fem::PrescribedDisplacement> all = on_symmetry;
    const double force_n = hertz_force_n(fraction * kIndentation_mm);
    for (const std::int32_t node : far) {
      const Vec3 u = boussinesq(model.mesh.nodes_L[std::size_t(node)], force_n);
      for (int c = 0; c < 3; ++c) prescribe({node}, c, u[c], all);
    }
    return all;
  };
  contact::ContactTerm contact(model.mesh.nodes_L, model.mesh.face_sets.at("z1"),
                               {.distance_query_B = sphere_B},
                               {.law = {.penalty_mpa_per_mm = kHertzStiffness_mpa_per_mm}});
  model.extra.push_back({&contact, [&](double fraction) {
                           RigidTransform X_LB = RigidTransform::Identity();
                           X_LB.translation().z() = -fraction * kIndentation_mm;
                           contact.set_pose(X_LB);
                         }});
  LEFORT_TRY(const Equilibrium found,
             solve(model, {.increments = 2, .relative_tolerance = 1e-7}, progress));

  Indented result{.points =
                      contact.contact_points(contact::displaced(model.mesh.nodes_L, found.u))};
  double moment = 0.0;
  for (const contact::ContactPoint& point : result.points) {
    result.force_n -= 4.0 * point.force_n.z();
    moment -= 4.0 * point.force_n.z() * point.x_L.head<2>().squaredNorm();
  }
  // Hertz's pressure p0 sqrt(1 - (r/a)^2) has the second moment 2/5 F a^2.
  result.radius_mm = std::sqrt(2.5 * moment / result.force_n);
  return result;
}

/// Mean pressure in rings around the axis; within a face, which is flatter than the sphere, the
/// pressure alternates from point to point.
report::PlotLine pressures(const std::string& name,
                           const std::vector<contact::ContactPoint>& points) {
  std::array<double, 7> force_n{};  // On a quarter of each ring; the last lies outside.
  const double width_mm = contact_radius_mm() / 6.0;
  for (const contact::ContactPoint& point : points) {
    const auto n = std::size_t(point.x_L.head<2>().norm() / width_mm);
    if (n < force_n.size()) force_n[n] += point.force_n.norm();
  }
  report::PlotLine line{.name = name};
  for (std::size_t n = 0; n < force_n.size(); ++n) {
    const double area_mm2 = 0.25 * pi * width_mm * width_mm * (2.0 * double(n) + 1.0);
    line.x.push_back((double(n) + 0.5) * width_mm);
    line.y.push_back(force_n[n] / area_mm2);
  }
  return line;
}

report::PlotLine hertz_pressure() {
  const double a_mm = contact_radius_mm();
  const double max_mpa = 1.5 * hertz_force_n(kIndentation_mm) / (pi * a_mm * a_mm);
  report::PlotLine line{.name = "Hertz"};
  for (int n = 0; n <= 50; ++n) {
    line.x.push_back(a_mm * std::sin(0.5 * pi * n / 50.0));
    line.y.push_back(max_mpa * std::cos(0.5 * pi * n / 50.0));
  }
  return line;
}

struct Series {
  mesh::ElementShape shape;
  std::vector<int> cells;
};

/// Shapes that do not average the volume lock at this Poisson's ratio.
std::vector<Series> all_series(Extent extent) {
  using enum mesh::ElementShape;
  if (extent == Extent::kShort) return {{kHex8, {3, 6, 12}}};
  return {{kHex8, {5, 10, 20}}, {kTet10, {2, 4, 8}}, {kWedge15, {2, 4, 8}}, {kHex20, {2, 4, 8}}};
}

/// Force and radius over Hertz's, coarse to fine.
struct HertzRatios {
  std::vector<double> forces = {}, radii = {};
  std::string failure = "";
};

HertzRatios indent_all(const Series& series,
                       const std::shared_ptr<const contact::DistanceQuery>& sphere_B, Table& table,
                       report::LinePlot& plot, Progress& progress) {
  HertzRatios ratios;
  for (const int n : series.cells) {
    const auto found = indent(series.shape, n, sphere_B, progress);
    if (!found) ratios.failure = found.error().message;
    if (!found) break;
    ratios.forces.push_back(found->force_n / hertz_force_n(kIndentation_mm));
    ratios.radii.push_back(found->radius_mm / contact_radius_mm());
    table.rows.push_back(
        {text_of(series.shape), fmt::format("{}", n), fmt::format("{}", found->points.size()),
         fmt::format("{:.4f}", ratios.forces.back()), fmt::format("{:.4f}", ratios.radii.back())});
    if (n == series.cells.back())
      plot.lines.push_back(pressures(text_of(series.shape), found->points));
  }
  return ratios;
}

/// Checks of the finest mesh of the full form.
void check_finest(const Series& series, const HertzRatios& ratios, Section& section) {
  const std::string name = text_of(series.shape);
  section.checks.push_back({.name = fmt::format("{}: force over Hertz's, finest", name),
                            .measured = ratios.forces.back(),
                            .comparison = Comparison::kNear,
                            .expected = 1.0,
                            .tolerance = 0.02,
                            .reason = "requirement for reliable contact"});
  const double cell_mm = edge_cell_mm(series.cells.back());
  section.checks.push_back(
      {.name = fmt::format("{}: radius of contact, finest", name),
       .measured = ratios.radii.back() * contact_radius_mm(),
       .comparison = Comparison::kNear,
       .expected = contact_radius_mm(),
       .tolerance = cell_mm,
       .unit = "mm",
       .reason = fmt::format("the edge length of the cell at its boundary, {:.3f} mm", cell_mm)});
}

void check_hertz(const Series& series, const HertzRatios& ratios, Extent extent, Section& section) {
  const std::string name = text_of(series.shape);
  if (!ratios.failure.empty()) {
    section.checks.push_back(not_measured(name, ratios.failure));
    return;
  }
  const Known known{.order = 2.0,
                    .order_reason = "2 for the block, as the pressure at the edge is continuous",
                    .allowance = kIndentation_mm / kHertzRadius_mm,
                    .allowance_reason = "strain is finite and the sphere no paraboloid: d / R"};
  check_convergence_order(fmt::format("{}: force over Hertz's", name), ratios.forces, known,
                          section);
  const std::span<const double> last = std::span(ratios.forces).last(3);
  section.checks.push_back(
      {.name = fmt::format("{}: difference of the radius over the force's predicted one", name),
       .measured =
           std::abs(ratios.radii.back() - 1.0) /
           (refinement_of({last[0], last[1], last[2]}, known.order).error + known.allowance),
       .comparison = Comparison::kAtMost,
       .expected = 1.0,
       .reason = "the force's error: both are moments of the same pressure, at the same points"});
  if (extent == Extent::kFull) check_finest(series, ratios, section);
}

Section hertz_section() {
  return {
      .name = "hertz",
      .title = "Rigid sphere on a half-space: Hertz's force and contact radius",
      .text = fmt::format(
          "A rigid sphere of {} mm, sampled as a distance field, is pressed {} mm into a nearly "
          "incompressible neo-Hookean block (nu = {:.4f}) by the penalty of the contact layer. "
          "Expected: F = 4/3 E* sqrt(R d^3) and a = sqrt(R d) (Hertz 1882; Johnson, Contact "
          "Mechanics, chapter 4). A quarter is meshed, {} contact radii wide and deep, with "
          "small cells around the contact. To represent a half-space, the far sides of the "
          "block have the displacements of Boussinesq's solution for Hertz's force. The radius "
          "of contact is that of Hertz's pressure with the measured second moment, 2/5 F a^2.",
          kHertzRadius_mm, kIndentation_mm, kHertzPoisson, kFarRadii)};
}

}  // namespace

Section verify_hertz(Extent extent, Progress& progress) {
  Section section = hertz_section();
  const auto field = field::build_distance_field(cap(), {.resolution = 64, .smooth = true});
  if (!field) {
    section.checks.push_back(not_measured("sphere", field.error().message));
    return section;
  }
  const auto sphere_B = contact::field_distance_query(
      std::make_shared<const field::DistanceField>(*field), contact::DetectionMethod::kSmooth);
  report::LinePlot plot{.title = "Pressure under the sphere, mean over rings",
                        .x_label = "distance from the axis [mm]",
                        .y_label = "pressure [MPa]",
                        .lines = {hertz_pressure()}};
  Table table{.title = "Force and radius of contact over Hertz's, by cells per side",
              .header = {"shape", "cells", "points in contact", "force", "radius"}};
  for (const Series& series : all_series(extent))
    check_hertz(series, indent_all(series, *sphere_B, table, plot, progress), extent, section);
  section.tables.push_back(std::move(table));
  section.plots.push_back(std::move(plot));
  return section;
}

}  // namespace lefort::verify
