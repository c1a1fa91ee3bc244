#include <lefort/verify/case_model.h>
#include <lefort/verify/cases.h>
#include <lefort/verify/check_convergence_order.h>
#include <lefort/verify/error_norms.h>
#include <lefort/verify/mapped_mesh.h>
#include <lefort/verify/shapes.h>

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace lefort::verify {
namespace {

using std::numbers::pi;

constexpr double kColumnRadius_mm = 1.0;
constexpr double kColumnLength_mm = 0.5;
constexpr double kColumnMu_mpa = 1.0;
constexpr double kColumnKappa_mpa = 1e4;
constexpr double kTwist_rad_per_mm = 0.6;

/// Relative change of the axial force by the compressibility of the material. By reciprocity it is
/// the integral of p p' over kappa and the force, with the hydrostatic pressure of the torsion,
/// p = mu tau^2 (a^2 / 2 - 5 r^2 / 6), and that of a unit stretch between fixed ends,
/// p' = mu (1 + 3 (a^2 - r^2) / L^2) (\cite gent1959).
constexpr double kAxialChange = -(1.0 / 3.0 + 4.0 / 3.0 * kColumnRadius_mm * kColumnRadius_mm /
                                                  (kColumnLength_mm * kColumnLength_mm)) *
                                kColumnMu_mpa / kColumnKappa_mpa;
/// Of kAxialChange: p' is a parabola only in the middle of a long gap; at L = a / 2 and L = a it
/// differs from converged values by 3 and 5 %.
constexpr double kAxialUncertainty = 0.1 * -kAxialChange;

/// Change of the torque, which varies as the fourth power of the radius: four times the change of
/// volume, at most mu tau^2 a^2 / 2 over kappa.
constexpr double kTorqueChange = 4.0 * 0.5 * kColumnMu_mpa * kTwist_rad_per_mm * kTwist_rad_per_mm *
                                 kColumnRadius_mm * kColumnRadius_mm / kColumnKappa_mpa;

/// The error of a load is the product of two errors of strain: of the solution, and of the
/// displacement by which that load does work (\cite babuska1984). For the torque, an additional
/// twist is as smooth as the solution. For the axial force, a stretch between fixed ends has a
/// singular stress at their edges: on regular meshes its strains have order 0.595 (bulging.cpp).
constexpr double kTorqueOrder = 2.0;
constexpr double kAxialOrder = 1.595;

/// The relative change of volume is at most mu tau^2 a^2 / 2, the pressure on the axis, over kappa;
/// so is that of displacements. At five times that, the order is correct to a few hundredths.
constexpr double kMinError = 5.0 * 0.5 * kColumnMu_mpa * kTwist_rad_per_mm * kTwist_rad_per_mm *
                             kColumnRadius_mm * kColumnRadius_mm / kColumnKappa_mpa;

struct EndLoads {
  double torque_nmm = 0.0;
  double axial_n = 0.0;  ///< Negative: the column tends to lengthen.
};

/// Rivlin's solution for the neo-Hookean law: pi mu tau a^4 / 2 and -pi mu tau^2 a^4 / 4; the
/// latter with the change by the compressibility.
EndLoads exact() {
  const double a4 = std::pow(kColumnRadius_mm, 4);
  const double tau = kTwist_rad_per_mm;
  return {0.5 * pi * kColumnMu_mpa * tau * a4,
          -0.25 * pi * kColumnMu_mpa * tau * tau * a4 * (1.0 + kAxialChange)};
}

/// Every section rotates rigidly.
ExactField exact_field() {
  const auto rotation = [](const Vec3& X) -> Mat3 {
    return Eigen::AngleAxisd(kTwist_rad_per_mm * X.z(), Vec3::UnitZ()).toRotationMatrix();
  };
  return {.displacement = [rotation](const Vec3& X) -> Vec3 { return rotation(X) * X - X; },
          .gradient =
              [rotation](const Vec3& X) {
                Mat3 gradient = rotation(X) - Mat3::Identity();
                gradient.col(2) += kTwist_rad_per_mm * Vec3::UnitZ().cross(rotation(X) * X);
                return gradient;
              }};
}

struct Twisted {
  EndLoads loads;
  double l2 = 0.0;  ///< Error of the displacement, relative.
};

Result<Twisted> twist(mesh::ElementShape shape, int cells, Progress& progress) {
  CaseModel model{.mesh = round_column(shape, cells, cells, kColumnRadius_mm, kColumnLength_mm),
                  .materials = {{0, decoupled_neo_hookean(kColumnMu_mpa, kColumnKappa_mpa)}},
                  .prescribed = {}};
  const auto bottom = nodes_where(model.mesh, [](const Vec3& p) { return p.z() < 1e-9; });
  const auto top =
      nodes_where(model.mesh, [](const Vec3& p) { return p.z() > kColumnLength_mm - 1e-9; });
  model.prescribed = [&](double fraction) {
    const Eigen::AngleAxisd rotation(fraction * kTwist_rad_per_mm * kColumnLength_mm,
                                     Vec3::UnitZ());
    RigidTransform motion_LL = RigidTransform::Identity();
    motion_LL.linear() = rotation.toRotationMatrix();
    std::vector<fem::PrescribedDisplacement> all = fem::prescribe_zero(bottom);
    const auto moved = fem::prescribe_rigid_motion(top, model.mesh.nodes_L, motion_LL);
    all.insert(all.end(), moved.begin(), moved.end());
    return all;
  };
  LEFORT_TRY(const Equilibrium found,
             solve(model, {.increments = 3, .relative_tolerance = 1e-9}, progress));
  EndLoads loads;
  for (const std::int32_t node : top) {
    const Vec3 x = model.mesh.nodes_L[std::size_t(node)] + found.u.segment<3>(3 * Index(node));
    const Vec3 force = found.reaction_n.segment<3>(3 * Index(node));
    loads.torque_nmm += x.x() * force.y() - x.y() * force.x();
    loads.axial_n += force.z();
  }
  return Twisted{.loads = loads, .l2 = error_norms(model.mesh, found.u, exact_field()).l2};
}

/// Meshes that halve, by cells in the section of each quarter: the core and the ring around it.
std::vector<int> column_meshes(mesh::ElementShape shape, Extent extent) {
  const bool is_full = extent == Extent::kFull;
  if (degree(shape) == 1) return is_full ? std::vector{3, 6} : std::vector{2, 4};
  return is_full ? std::vector{1, 2, 4} : std::vector{1, 2};
}

/// Checks the error of an end load. An error below the change by the compressibility of the
/// material shows no order.
void check_load(const std::string& name, std::span<const double> errors, double compressibility,
                const Known& known, Section& section) {
  if (errors.back() < compressibility)
    section.checks.push_back({.name = name + ": error",
                              .measured = errors.back(),
                              .comparison = Comparison::kAtMost,
                              .tolerance = compressibility,
                              .reason = "the change by the compressibility of the material: no "
                                        "order can be measured"});
  else
    check_error_order(name, errors, known, section);
}

/// Errors of one shape, coarse to fine.
struct TorsionErrors {
  std::vector<double> torque = {}, axial = {};
  std::vector<double> displacement = {};  ///< Only those that show an order.
  double last_displacement = NAN;
  std::string failure = "";
};

/// Order between the last two errors as text.
std::string last_order(const std::vector<double>& errors) {
  return errors.size() < 2 ? ""
                           : fmt::format("{:.2f}", std::log2(errors.end()[-2] / errors.back()));
}

TorsionErrors twist_all(mesh::ElementShape shape, Extent extent, Table& table,
                        report::PlotLine& line, Progress& progress) {
  const EndLoads wanted = exact();
  TorsionErrors errors;
  for (const int n : column_meshes(shape, extent)) {
    const auto found = twist(shape, n, progress);
    if (!found) errors.failure = found.error().message;
    if (!found) break;
    const double torque = found->loads.torque_nmm / wanted.torque_nmm - 1.0;
    const double axial = found->loads.axial_n / wanted.axial_n - 1.0;
    errors.torque.push_back(std::abs(torque));
    errors.axial.push_back(std::abs(axial));
    if (found->l2 >= kMinError) errors.displacement.push_back(found->l2);
    errors.last_displacement = found->l2;
    table.rows.push_back({text_of(shape), fmt::format("{}", n), fmt::format("{:+.2e}", torque),
                          last_order(errors.torque), fmt::format("{:+.2e}", axial),
                          last_order(errors.axial), fmt::format("{:.2e}", found->l2),
                          found->l2 >= kMinError ? last_order(errors.displacement) : ""});
    line.x.push_back(std::log2(n));
    line.y.push_back(std::hypot(torque, axial));
  }
  return errors;
}

void check_displacement(mesh::ElementShape shape, const TorsionErrors& errors, Section& section) {
  const std::string name = fmt::format("{}: displacement, L2", text_of(shape));
  if (errors.displacement.size() >= 2)
    check_error_order(name, errors.displacement,
                      {.order = averaged_order(shape),
                       .order_reason = "at least p + 1, with the degree p of the displacement"},
                      section);
  else
    section.checks.push_back({.name = name + ": error",
                              .measured = errors.last_displacement,
                              .comparison = Comparison::kAtMost,
                              .tolerance = kMinError,
                              .reason = "five times the effect of the compressibility of the "
                                        "material: no order can be measured"});
}

void check_torsion(mesh::ElementShape shape, const TorsionErrors& errors, Section& section) {
  const std::string name = text_of(shape);
  if (!errors.failure.empty()) {
    section.checks.push_back(not_measured(name, errors.failure));
    return;
  }
  check_load(
      name + ": torque", errors.torque, kTorqueChange,
      {.order = kTorqueOrder, .order_reason = "at least twice that of the strains, which is 1"},
      section);
  check_load(name + ": axial force", errors.axial, kAxialUncertainty,
             {.order = kAxialOrder,
              .order_reason = "at least 1 for the strains plus 0.595 for those of a stretch, which "
                              "are singular at the edges of the fixed ends"},
             section);
  check_displacement(shape, errors, section);
}

Section torsion_section() {
  const EndLoads wanted = exact();
  return {
      .name = "torsion",
      .title = "Twisted column: Rivlin's torque and axial force",
      .text = fmt::format(
          "A circular column, {} mm long and {} mm in radius, of an incompressible neo-Hookean "
          "material (bulk over shear modulus {:.0g}) is twisted by {} rad/mm between ends at a "
          "fixed distance. Rivlin (Large elastic deformations of isotropic materials VI, 1949) "
          "showed that every section rotates rigidly, for any twist; the ends need the torque pi "
          "mu tau a^4 / 2 = {:.5f} N mm and the axial force -pi mu tau^2 a^4 / 4 = {:.5f} N, "
          "which does not occur in linear theory; it is corrected for the compressibility of the "
          "material. Expected orders: of the displacement in the L2 "
          "norm 3 for hex20, tet10 and wedge15, 2 for hex8; of the torque 2; of the axial force "
          "1.595, since "
          "the axial stretch, on which this force does work, is singular at the edges of the "
          "fixed ends, where strains have order 0.595.",
          kColumnLength_mm, kColumnRadius_mm, kColumnKappa_mpa, kTwist_rad_per_mm,
          wanted.torque_nmm, wanted.axial_n)};
}

}  // namespace

Section verify_torsion(Extent extent, Progress& progress) {
  Section section = torsion_section();
  Table table{.title =
                  "Errors of the end loads and, in the L2 norm, of the displacement, by cells "
                  "from the axis to the side of the core and from there to the surface",
              .header = {"shape", "cells", "torque", "order", "axial force", "order",
                         "displacement", "order"}};
  report::LinePlot plot{.title = "Twisted column: error of torque and axial force",
                        .x_label = "refinement: log2 of the cells",
                        .y_label = "relative error",
                        .y_axis = report::Axis::kLog};
  double done = 0.0;
  for (const mesh::ElementShape shape : kAveragedShapes) {
    report::PlotLine line{.name = text_of(shape)};
    const TorsionErrors errors = twist_all(shape, extent, table, line, progress);
    progress.report(++done / double(kAveragedShapes.size()));
    plot.lines.push_back(std::move(line));
    check_torsion(shape, errors, section);
  }
  section.tables.push_back(std::move(table));
  section.plots.push_back(std::move(plot));
  return section;
}

}  // namespace lefort::verify
