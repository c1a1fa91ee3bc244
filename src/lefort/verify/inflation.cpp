#include <lefort/fem/loads/follower_pressure.h>
#include <lefort/verify/case_model.h>
#include <lefort/verify/cases.h>
#include <lefort/verify/check_convergence_order.h>
#include <lefort/verify/mapped_mesh.h>
#include <lefort/verify/reference_laws.h>
#include <lefort/verify/shapes.h>

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace lefort::verify {
namespace {

constexpr double kInner_mm = 1.0;
constexpr double kOuter_mm = 2.0;
constexpr double kShellMu_mpa = 1.0;
constexpr double kShellKappa_mpa = 1e4;
constexpr double kInflation = 1.3;  ///< Inner radius, current over reference.

enum class Vessel { kCylinder, kSphere };

/// Inner pressure of an incompressible neo-Hookean tube in plane strain, whose wall preserves
/// r^2 - R^2: p = mu/2 [2 ln(la/lb) + lb^-2 - la^-2], with la, lb the hoop stretches inside and
/// outside: the integral of mu (l^2 - l^-2) / r over the wall.
double cylinder_pressure(double la) {
  const double a = la * kInner_mm;
  const double lb = std::sqrt(kOuter_mm * kOuter_mm + a * a - kInner_mm * kInner_mm) / kOuter_mm;
  return 0.5 * kShellMu_mpa * (2.0 * std::log(la / lb) + std::pow(lb, -2) - std::pow(la, -2));
}

/// The same of a hollow sphere, which preserves r^3 - R^3: p = mu/2 [4/lb + lb^-4 - 4/la - la^-4].
double sphere_pressure(double la) {
  const double a = la * kInner_mm;
  const double lb =
      std::cbrt(std::pow(kOuter_mm, 3) + std::pow(a, 3) - std::pow(kInner_mm, 3)) / kOuter_mm;
  const auto at = [](double l) { return 4.0 / l + std::pow(l, -4); };
  return 0.5 * kShellMu_mpa * (at(lb) - at(la));
}

double pressure_of(Vessel vessel) {
  return vessel == Vessel::kCylinder ? cylinder_pressure(kInflation) : sphere_pressure(kInflation);
}

fem::Material wall_law() { return decoupled_neo_hookean(kShellMu_mpa, kShellKappa_mpa); }

/// State of a point on a ray through the wall: current radius and radial nominal stress.
struct Ray {
  double r_mm = 0.0;
  double stress_mpa = 0.0;
};

/// d/dR of both: dr/dR is the radial stretch for the stress, and radial equilibrium gives
/// dP_r/dR = (P_hoop - P_r) / R in a tube, twice that in a sphere.
Ray slope(Vessel vessel, double R_mm, const Ray& at) {
  const bool is_tube = vessel == Vessel::kCylinder;
  const double hoop = at.r_mm / R_mm;
  const auto stress = [&](double radial) {
    return principal_stress(wall_law(), {radial, hoop, is_tube ? 1.0 : hoop});
  };
  double radial = 1.0 / (is_tube ? hoop : hoop * hoop);
  for (int n = 0; n < 4; ++n) {  // Newton's method by differences; the start is within p / kappa.
    constexpr double kStep = 1e-6;
    const double by = (stress(radial + kStep)[0] - stress(radial - kStep)[0]) / (2.0 * kStep);
    radial -= (stress(radial)[0] - at.stress_mpa) / by;
  }
  const Vec3 P = stress(radial);
  return {radial, (is_tube ? 1.0 : 2.0) * (P[1] - P[0]) / R_mm};
}

/// Radial stress at the outer radius if the inner radius is `a_mm` under pressure p: fourth-order
/// Runge-Kutta steps from inside to outside.
double outer_stress(Vessel vessel, double a_mm, double p_mpa) {
  constexpr int kSteps = 200;
  const double h = (kOuter_mm - kInner_mm) / kSteps;
  const double hoop = a_mm / kInner_mm;
  Ray ray{a_mm, -p_mpa * (vessel == Vessel::kCylinder ? hoop : hoop * hoop)};
  const auto moved = [](const Ray& from, double step, const Ray& by) {
    return Ray{from.r_mm + step * by.r_mm, from.stress_mpa + step * by.stress_mpa};
  };
  for (int n = 0; n < kSteps; ++n) {
    const double R = kInner_mm + n * h;
    const Ray k1 = slope(vessel, R, ray);
    const Ray k2 = slope(vessel, R + 0.5 * h, moved(ray, 0.5 * h, k1));
    const Ray k3 = slope(vessel, R + 0.5 * h, moved(ray, 0.5 * h, k2));
    const Ray k4 = slope(vessel, R + h, moved(ray, h, k3));
    ray = moved(moved(moved(moved(ray, h / 6.0, k1), h / 3.0, k2), h / 3.0, k3), h / 6.0, k4);
  }
  return ray.stress_mpa;
}

/// Inner radius of the wall with its actual bulk modulus under pressure p: the outside must be free
/// of stress. Secant method from the incompressible radius.
double inner_radius(Vessel vessel, double p_mpa) {
  double a = kInflation * kInner_mm;
  double before = a * (1.0 + 1e-4);
  double f_before = outer_stress(vessel, before, p_mpa);
  for (int n = 0; n < 4; ++n) {
    const double f = outer_stress(vessel, a, p_mpa);
    if (std::abs(a - before) < 1e-13) break;
    const double next = a - f * (a - before) / (f - f_before);
    before = a;
    f_before = f;
    a = next;
  }
  return a;
}

/// Error of the inner radius as a fraction of its growth: root mean square over the nodes. (Not the
/// mean: errors of both signs cancel in it, so that it can vanish on a coarse mesh.)
Result<double> radius_error(Vessel vessel, mesh::ElementShape shape, int cells, double wanted_mm,
                            Progress& progress) {
  const bool is_tube = vessel == Vessel::kCylinder;
  CaseModel model{.mesh = is_tube ? quarter_ring(shape, cells, kInner_mm, kOuter_mm, 0.5 / cells)
                                  : octant_shell(shape, cells, kInner_mm, kOuter_mm),
                  .materials = {{0, wall_law()}},
                  .prescribed = {}};
  std::vector<fem::PrescribedDisplacement> prescribed;
  for (int axis = 0; axis < 3; ++axis)
    prescribe(nodes_where(model.mesh,
                          [&](const Vec3& p) {
                            return std::abs(p[axis]) < 1e-9 || (is_tube && axis == 2);
                          }),
              axis, 0.0, prescribed);
  model.prescribed = in_proportion(std::move(prescribed));
  LEFORT_TRY(const auto pressure,
             fem::FollowerPressure::build(model.mesh.nodes_L, model.mesh.face_sets.at("inner")));
  const double full_mpa = pressure_of(vessel);
  model.extra.push_back(
      {pressure.get(), [&](double fraction) { pressure->set_pressure_mpa(fraction * full_mpa); }});
  LEFORT_TRY(const Equilibrium found,
             solve(model, {.increments = 3, .relative_tolerance = 1e-8}, progress));

  const auto radius = [&](const Vec3& p) { return is_tube ? p.head<2>().norm() : p.norm(); };
  const auto inner =
      nodes_where(model.mesh, [&](const Vec3& p) { return radius(p) < kInner_mm + 1e-6; });
  const double wanted_growth_mm = wanted_mm - kInner_mm;
  double sum = 0.0;
  for (const std::int32_t node : inner) {
    const Vec3 p = model.mesh.nodes_L[std::size_t(node)] + found.u.segment<3>(3 * Index(node));
    const double fraction = (radius(p) - kInner_mm) / wanted_growth_mm;
    sum += std::pow(fraction - 1.0, 2);
  }
  return std::sqrt(sum / double(inner.size()));
}

const char* name_of_vessel(Vessel vessel) {
  return vessel == Vessel::kCylinder ? "cylinder" : "sphere";
}

/// Order of the radius. In hex20 the pressure at a corner of one element only is that of its
/// neighbors (lone_corners.h): its error there is of the first order, and that of the displacement
/// beside it of the second. Such corners are the ends of the arc of the cylinder: a part h of its
/// nodes, so that the root mean square has order 2.5; and the three corners of the octant.
double radius_order(mesh::ElementShape shape) {
  return shape == mesh::ElementShape::kHex20 ? 2.5 : averaged_order(shape);
}

/// Cells across the wall. The sphere with eight quadratic elements across needs ten minutes.
std::vector<int> vessel_meshes(Vessel vessel, mesh::ElementShape shape, Extent extent) {
  const bool is_full = extent == Extent::kFull;
  if (vessel == Vessel::kCylinder) return is_full ? std::vector{2, 4, 8, 16} : std::vector{2, 4, 8};
  const int coarsest = degree(shape) == 2 ? 1 : 2;
  std::vector<int> cells{coarsest, 2 * coarsest};
  if (is_full) cells.push_back(4 * coarsest);
  return cells;
}

void check_reference_radius(Vessel vessel, double wanted_mm, Section& section) {
  section.checks.push_back(
      {.name = fmt::format("{}: radius of the compressible wall less the closed form's",
                           name_of_vessel(vessel)),
       .measured = wanted_mm - kInflation * kInner_mm,
       .tolerance = 3.0 * pressure_of(vessel) / kShellKappa_mpa,
       .unit = "mm",
       .reason = "the wall is compressed by the pressure over kappa; three times that for the "
                 "growth of its radii"});
}

/// Inflates a vessel of one shape on all meshes.
void inflate(Vessel vessel, mesh::ElementShape shape, Extent extent, double wanted_mm, Table& table,
             report::LinePlot& plot, Section& section, Progress& progress) {
  std::vector<std::string> row{text_of(shape)};
  report::PlotLine line{.name = text_of(shape)};
  std::vector<double> errors;
  std::string failure;
  for (const int n : vessel_meshes(vessel, shape, extent)) {
    const auto found = radius_error(vessel, shape, n, wanted_mm, progress);
    if (!found) failure = found.error().message;
    if (!found) break;
    errors.push_back(*found);
    row.push_back(fmt::format("{:.2e}", *found));
    line.x.push_back(std::log2(n));
    line.y.push_back(*found);
  }
  const std::string name = fmt::format("{}, {}", name_of_vessel(vessel), text_of(shape));
  if (!failure.empty()) {
    section.checks.push_back(not_measured(name, failure));
    return;
  }
  row.push_back(fmt::format("{:.2f}", std::log2(errors.end()[-2] / errors.back())));
  table.rows.push_back(std::move(row));
  plot.lines.push_back(std::move(line));
  check_error_order(
      name, errors,
      {.order = radius_order(shape),
       .order_reason = "at least p + 1; 2.5 for hex20, whose pressure at lone corners is not free",
       .known_failure = extent == Extent::kShort && shape == mesh::ElementShape::kHex20
                            ? "the meshes of the short form are too coarse for it"
                            : ""},
      section);
}

Section inflation_section() {
  return {
      .name = "inflation",
      .title = "Thick-walled cylinder and sphere under inner pressure",
      .text = fmt::format(
          "Radii 1 and 2 mm, incompressible neo-Hookean (here bulk over shear modulus {:.0g}). A "
          "follower pressure inflates the wall from inside until the inner radius has grown by 30 "
          "%. A quarter of the tube in plane strain and an octant of the sphere are meshed, with "
          "curved faces and elements if the shape allows. The pressure for that radius is known "
          "(Green and Zerna, Theoretical Elasticity, chapter 3): {:.6f} MPa and {:.6f} MPa. The "
          "compressibility of the wall would hide the order. The reference radius is therefore "
          "computed for the compressible law, from the radial equation of equilibrium by Runge "
          "and Kutta's method, and compared with the closed form. The report has the error of the "
          "inner radius as a fraction of its growth. Expected orders: 3 for tet10 and wedge15, 2 "
          "for hex8, 2.5 for hex20, whose pressure is not free at corners of one element only. The "
          "error on the finest mesh must be that predicted from the two meshes before it.",
          kShellKappa_mpa, pressure_of(Vessel::kCylinder), pressure_of(Vessel::kSphere))};
}

}  // namespace

Section verify_inflation(Extent extent, Progress& progress) {
  Section section = inflation_section();
  double done = 0.0;
  for (const Vessel vessel : {Vessel::kCylinder, Vessel::kSphere}) {
    const char* const what = name_of_vessel(vessel);
    const double wanted_mm = inner_radius(vessel, pressure_of(vessel));
    check_reference_radius(vessel, wanted_mm, section);
    Table table{.title = fmt::format("{}: error of the inner radius over its growth", what),
                .header = {"shape"}};
    const auto linear = vessel_meshes(vessel, mesh::ElementShape::kHex8, extent);
    const auto quadratic = vessel_meshes(vessel, mesh::ElementShape::kHex20, extent);
    for (std::size_t k = 0; k < linear.size(); ++k)
      table.header.push_back(linear == quadratic
                                 ? fmt::format("{} cells across", linear[k])
                                 : fmt::format("{} (hex8) or {} cells", linear[k], quadratic[k]));
    table.header.emplace_back("order");
    report::LinePlot plot{.title = fmt::format("Inflated {}: error of the inner radius", what),
                          .x_label = "refinement: log2 of the cells across the wall",
                          .y_label = "error over growth",
                          .y_axis = report::Axis::kLog};
    for (const mesh::ElementShape shape : kAveragedShapes) {
      inflate(vessel, shape, extent, wanted_mm, table, plot, section, progress);
      progress.report(++done / double(2 * kAveragedShapes.size()));
    }
    section.tables.push_back(std::move(table));
    section.plots.push_back(std::move(plot));
  }
  return section;
}

}  // namespace lefort::verify
