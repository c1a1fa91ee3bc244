#include <lefort/fem/loads/follower_pressure.h>
#include <lefort/mesh/box_grid.h>
#include <lefort/verify/case_model.h>
#include <lefort/verify/cases.h>
#include <lefort/verify/fiber_tension.h>
#include <lefort/verify/mapped_mesh.h>
#include <lefort/verify/shapes.h>

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace lefort::verify {
namespace {

using std::numbers::pi;

/// Bulk modulus [MPa] of all problems: 1000 times the bulk of the stresses.
constexpr double kCardiacKappa_mpa = 10.0;

/// Guccione's law: Psi = C / 2 (e^Q - 1) with Q = b_f E_ff^2 + b_t (E_ss^2 + E_nn^2 + 2 E_sn^2) +
/// 2 b_fs (E_fs^2 + E_fn^2) (\cite land2015, eq. 2).
struct Guccione {
  double c_mpa = 0.0;
  double b_f = 1.0, b_t = 1.0, b_fs = 1.0;
};

/// \param axes  columns f, s, n.
fem::Material law_of(const Guccione& law, const Mat3& axes) {
  fem::FungOrthotropic fung{.c_mpa = law.c_mpa, .axes = axes};
  fung.mu_mpa = law.c_mpa * Vec3(law.b_fs - 0.5 * law.b_t, 0.5 * law.b_t, 0.5 * law.b_t);
  fung.lambda_mpa(0, 0) = law.c_mpa * (law.b_f - 2.0 * law.b_fs + law.b_t);
  return fem::DecoupledLaw<fem::FungOrthotropic>{
      .isochoric = fung,
      .volume = {.form = fem::VolumetricForm::kQuadraticLog, .kappa_mpa = kCardiacKappa_mpa}};
}

/// A benchmark problem. z of the apex of a ventricle is that of script/reference_ventricle.
struct CardiacProblem {
  const char* name;
  Guccione law;
  double pressure_mpa;
  double tension_mpa;
  int increments;
  std::array<double, 2> wanted_mm = {};  ///< z inside and outside.
  double tolerance = 0.0;                ///< On fine meshes, relative.
};
constexpr CardiacProblem kBeam{.name = "beam",
                               .law = {.c_mpa = 0.002, .b_f = 8.0, .b_t = 2.0, .b_fs = 4.0},
                               .pressure_mpa = 4e-6,
                               .tension_mpa = 0.0,
                               .increments = 5};
constexpr CardiacProblem kInflated{.name = "inflated ventricle",
                                   .law = {.c_mpa = 0.01, .b_f = 1.0, .b_t = 1.0, .b_fs = 1.0},
                                   .pressure_mpa = 0.01,
                                   .tension_mpa = 0.0,
                                   .increments = 10,
                                   .wanted_mm = {-26.77, -28.42},
                                   .tolerance = 0.01};
constexpr CardiacProblem kContracting{.name = "contracting ventricle",
                                      .law = {.c_mpa = 0.002, .b_f = 8.0, .b_t = 2.0, .b_fs = 4.0},
                                      .pressure_mpa = 0.015,
                                      .tension_mpa = 0.06,
                                      .increments = 20,
                                      .wanted_mm = {-12.34, -15.46},
                                      .tolerance = 0.025};

/// The wall of the ventricle: a truncated ellipsoid with semi-axes 7 + 3 t and 17 + 3 t mm, from t
/// = 0 inside to 1 outside, base at z = 5 mm, apex at z = -17 and -20 mm.
constexpr double kBase_mm = 5.0;
double short_axis_mm(double t) { return 7.0 + 3.0 * t; }
double long_axis_mm(double t) { return 17.0 + 3.0 * t; }

/// \param at  a point of the disk of radius 1, from the apex to the base, and 1 - t.
Vec3 in_wall(const Vec3& at) {
  const double t = 1.0 - at.z();
  const double from_apex = at.head<2>().norm();
  const double angle = from_apex * (pi - std::acos(kBase_mm / long_axis_mm(t)));
  const double r_mm = short_axis_mm(t) * std::sin(angle);
  const Eigen::Vector2d direction =
      from_apex > 0.0 ? Eigen::Vector2d(at.head<2>() / from_apex) : Eigen::Vector2d::Zero();
  return {r_mm * direction.x(), r_mm * direction.y(), -long_axis_mm(t) * std::cos(angle)};
}

/// t of a point, by Newton's method for r^2 / a^2 + z^2 / b^2 = 1.
double depth_in_wall(const Vec3& X) {
  double t = 0.5;
  for (int n = 0; n < 20; ++n) {
    const double a = short_axis_mm(t);
    const double b = long_axis_mm(t);
    const double r2 = X.head<2>().squaredNorm();
    const double z2 = X.z() * X.z();
    t += (r2 / (a * a) + z2 / (b * b) - 1.0) / (6.0 * r2 / (a * a * a) + 6.0 * z2 / (b * b * b));
  }
  return t;
}

/// Fibers, sheets and normals of the wall: the fibers turn from 90 degrees to the circumference
/// inside to -90 degrees outside (\cite land2015, section 2.4).
Mat3 axes_in_wall(const Vec3& X) {
  const double t = depth_in_wall(X);
  const double r = std::max(X.head<2>().norm(), 1e-9);
  const Vec3 outwards(X.x() / r, X.y() / r, 0.0);
  const double sine = r / short_axis_mm(t);  // Of the angle from the apex.
  const double cosine = -X.z() / long_axis_mm(t);
  const Vec3 meridian =
      (short_axis_mm(t) * cosine * outwards + long_axis_mm(t) * sine * Vec3::UnitZ()).normalized();
  const Vec3 around = Vec3::UnitZ().cross(outwards);
  const double helix = 0.5 * pi - pi * t;
  Mat3 axes;
  axes.col(0) = std::sin(helix) * meridian + std::cos(helix) * around;
  axes.col(2) = meridian.cross(around);
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return axes;
}

Vec3 centroid(const mesh::VolumeMesh& mesh, const mesh::ElementBlock& block, Index e) {
  const int count = mesh::node_count(block.shape);
  Vec3 sum = Vec3::Zero();
  for (int a = 0; a < count; ++a) sum += mesh.nodes_L[std::size_t(block.element(e)[a])];
  return sum / count;
}

/// The ventricle with the axes of the law at the centroid of each element.
CaseModel ventricle_model(const CardiacProblem& problem, mesh::ElementShape shape, int cells,
                          int layers) {
  CaseModel model{.mesh = mapped(round_column(shape, cells, layers, 1.0, 1.0), in_wall),
                  .materials = {},
                  .prescribed = {}};
  mesh::ElementBlock& block = model.mesh.blocks.front();
  for (Index e = 0; e < block.element_count(); ++e) {
    block.region[std::size_t(e)] = std::int32_t(e);
    model.materials[std::int32_t(e)] =
        law_of(problem.law, axes_in_wall(centroid(model.mesh, block, e)));
  }
  std::vector<fem::PrescribedDisplacement> prescribed;
  const auto base = nodes_where(model.mesh, [](const Vec3& p) { return p.z() > kBase_mm - 1e-9; });
  for (int axis = 0; axis < 3; ++axis) prescribe(base, axis, 0.0, prescribed);
  model.prescribed = in_proportion(std::move(prescribed));
  return model;
}

/// z of the apex inside and outside [mm], at full load.
struct Apex {
  double inner_mm = NAN, outer_mm = NAN;
};

Result<Apex> load_ventricle(const CardiacProblem& problem, mesh::ElementShape shape, int cells,
                            int layers, Progress& progress) {
  CaseModel model = ventricle_model(problem, shape, cells, layers);
  LEFORT_TRY(const auto pressure,
             fem::FollowerPressure::build(model.mesh.nodes_L, model.mesh.face_sets.at("z1")));
  LEFORT_TRY(const auto tension, FiberTension::build(model.mesh, [](const Vec3& X) -> Vec3 {
               return axes_in_wall(X).col(0);
             }));
  model.extra.push_back({pressure.get(), [&](double fraction) {
                           pressure->set_pressure_mpa(fraction * problem.pressure_mpa);
                         }});
  if (problem.tension_mpa > 0.0)
    model.extra.push_back({tension.get(), [&](double fraction) {
                             tension->set_tension_mpa(fraction * problem.tension_mpa);
                           }});
  LEFORT_TRY(
      const Equilibrium found,
      solve(model, {.increments = problem.increments, .relative_tolerance = 1e-7}, progress));
  const auto apex = [&](double t) {
    const auto at = nodes_where(model.mesh, [&](const Vec3& p) {
      return (p - in_wall({0.0, 0.0, 1.0 - t})).norm() < 1e-6;
    });
    return -long_axis_mm(t) + found.u[3 * Index(at.front()) + 2];
  };
  return Apex{.inner_mm = apex(0.0), .outer_mm = apex(1.0)};
}

/// z of the middle of the upper edge of the beam's free end [mm].
Result<double> bend_beam(mesh::ElementShape shape, int cells, Progress& progress) {
  CaseModel model{.mesh = mesh::make_box(shape, {10 * cells, cells, cells}, Vec3(10.0, 1.0, 1.0)),
                  .materials = {{0, law_of(kBeam.law, Mat3::Identity())}},
                  .prescribed = {}};
  std::vector<fem::PrescribedDisplacement> prescribed;
  const auto clamped = nodes_where(model.mesh, [](const Vec3& p) { return p.x() < 1e-9; });
  for (int axis = 0; axis < 3; ++axis) prescribe(clamped, axis, 0.0, prescribed);
  model.prescribed = in_proportion(std::move(prescribed));
  LEFORT_TRY(const auto pressure,
             fem::FollowerPressure::build(model.mesh.nodes_L, model.mesh.face_sets.at("z0")));
  model.extra.push_back({pressure.get(), [&](double fraction) {
                           pressure->set_pressure_mpa(fraction * kBeam.pressure_mpa);
                         }});
  LEFORT_TRY(const Equilibrium found,
             solve(model, {.increments = kBeam.increments, .relative_tolerance = 1e-8}, progress));
  const auto at = nodes_where(
      model.mesh, [](const Vec3& p) { return (p - Vec3(10.0, 0.5, 1.0)).norm() < 1e-6; });
  return 1.0 + found.u[3 * Index(at.front()) + 2];
}

/// z of the end of the beam (\cite land2015, figure 3), and its relative spread.
constexpr double kBeamEnd_mm = 4.17;
constexpr double kBeamSpread = 0.01;
/// Of ventricles with one layer of elements, within which fibers turn by 180 degrees.
constexpr double kCoarseTolerance = 0.05;

struct CardiacMesh {
  mesh::ElementShape shape;
  int cells, layers;
  bool is_fine;
};

void bend_beams(Extent extent, Section& section, Progress& progress) {
  using enum mesh::ElementShape;
  Table table{.title = "Beam: z of the free end [mm]", .header = {"shape", "cells across", "z"}};
  const auto add = [&](mesh::ElementShape shape, int cells) {
    const std::string name = fmt::format("beam, {}, {} cells across", text_of(shape), cells);
    const auto found = bend_beam(shape, cells, progress);
    if (!found) {
      section.checks.push_back(not_measured(name, found.error().message));
      return;
    }
    table.rows.push_back({text_of(shape), fmt::format("{}", cells), fmt::format("{:.3f}", *found)});
    section.checks.push_back({.name = name,
                              .measured = *found,
                              .expected = kBeamEnd_mm,
                              .tolerance = kBeamSpread * kBeamEnd_mm,
                              .unit = "mm",
                              .reason = "spread of the published solutions"});
  };
  add(kHex20, 1);
  if (extent == Extent::kFull) add(kTet10, 2);
  if (extent == Extent::kFull) add(kHex8, 4);
  section.tables.push_back(std::move(table));
}

void check_apex(const CardiacProblem& problem, const CardiacMesh& mesh, const Apex& apex,
                const std::string& name, Section& section) {
  const double tolerance = mesh.is_fine ? problem.tolerance : kCoarseTolerance;
  const std::array values{apex.inner_mm, apex.outer_mm};
  for (const std::size_t side : {0, 1})
    section.checks.push_back(
        {.name = name + (side == 0 ? ": z of the apex inside" : ": z of the apex outside"),
         .measured = values[side],
         .expected = problem.wanted_mm[side],
         .tolerance = std::abs(tolerance * problem.wanted_mm[side]),
         .unit = "mm",
         .reason =
             mesh.is_fine
                 ? "the published solutions agree within about 0.5 %; the axes of the law are "
                   "constant in an element"
                 : "one layer of elements, in which fibers turn by 180 degrees"});
}

void load_ventricles(const CardiacProblem& problem, Extent extent, Section& section,
                     Progress& progress) {
  using enum mesh::ElementShape;
  std::vector<CardiacMesh> meshes{{kHex20, 2, 1, false}};
  if (extent == Extent::kFull) {
    meshes.push_back({kHex20, 4, 3, true});
    meshes.push_back({kTet10, 4, 3, true});
  }
  Table table{.title = fmt::format("{}: z of the apex [mm]", problem.name),
              .header = {"shape", "cells", "layers", "inside", "outside"}};
  for (const CardiacMesh& mesh : meshes) {
    const std::string name =
        fmt::format("{}, {}, {} layers", problem.name, text_of(mesh.shape), mesh.layers);
    const auto apex = load_ventricle(problem, mesh.shape, mesh.cells, mesh.layers, progress);
    if (!apex) {
      section.checks.push_back(not_measured(name, apex.error().message));
      continue;
    }
    table.rows.push_back({text_of(mesh.shape), fmt::format("{}", mesh.cells),
                          fmt::format("{}", mesh.layers), fmt::format("{:.3f}", apex->inner_mm),
                          fmt::format("{:.3f}", apex->outer_mm)});
    check_apex(problem, mesh, *apex, name, section);
  }
  section.tables.push_back(std::move(table));
}

}  // namespace

Section verify_cardiac(Extent extent, Progress& progress) {
  Section section{
      .name = "cardiac",
      .title = "Beam and ventricle: the benchmark problems of cardiac mechanics",
      .text = fmt::format(
          "The three problems of Land et al. (Verification of cardiac mechanics software, Proc. R. "
          "Soc. A 471, 2015) with Guccione's law, here with a bulk modulus of {} MPa. 1: a beam of "
          "10 x 1 x 1 mm with fibers along its length, clamped at one end, under a follower "
          "pressure of 4 Pa from below. 2: a ventricle, a truncated ellipsoid with a fixed base, "
          "of an isotropic law, inflated by 10 kPa. 3: the ventricle with fibers that turn from 90 "
          "degrees inside to -90 degrees outside, 15 kPa inside and a tension of 60 kPa along the "
          "fibers. The published solutions of 1 are near {} mm. The references of 2 and 3 are "
          "axisymmetric solutions with twist by an independent code, FEniCSx "
          "(script/reference_ventricle): exactly incompressible, on up to 3 x 24 and 16 x 128 "
          "cells; the two finest meshes of each differ by less than 0.3 %. The axes of the law are "
          "constant in an element; the tension has its "
          "own direction at each point.",
          kCardiacKappa_mpa, kBeamEnd_mm)};
  bend_beams(extent, section, progress);
  progress.report(0.2);
  load_ventricles(kInflated, extent, section, progress);
  progress.report(0.5);
  load_ventricles(kContracting, extent, section, progress);
  return section;
}

}  // namespace lefort::verify
