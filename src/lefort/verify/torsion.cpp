#include <lefort/verify/case_model.h>
#include <lefort/verify/cases.h>
#include <lefort/verify/mapped_mesh.h>
#include <lefort/verify/shapes.h>

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <utility>

namespace lefort::verify {
namespace {

using std::numbers::pi;

constexpr double kRadius_mm = 1.0;
constexpr double kLength_mm = 1.0;
constexpr double kMu_mpa = 1.0;
constexpr double kKappa_mpa = 1e4;
constexpr double kTwist_rad_per_mm = 0.6;

struct EndLoads {
  double torque_nmm = 0.0;
  double axial_n = 0.0;  ///< Negative: the column wants to lengthen.
};

/// Rivlin's solution for the neo-Hookean law: pi mu tau a^4 / 2 and -pi mu tau^2 a^4 / 4.
EndLoads exact() {
  const double a4 = std::pow(kRadius_mm, 4);
  const double tau = kTwist_rad_per_mm;
  return {0.5 * pi * kMu_mpa * tau * a4, -0.25 * pi * kMu_mpa * tau * tau * a4};
}

Result<EndLoads> twist(mesh::ElementShape shape, int cells, Progress& progress) {
  CaseModel model{.mesh = round_column(shape, cells, 2 * cells, kRadius_mm, kLength_mm),
                  .materials = {{0,
                                 fem::Split<fem::IsochoricNeoHookean>{
                                     .shear = {.mu_mpa = kMu_mpa},
                                     .volume = {.form = fem::VolumetricForm::kQuadraticLog,
                                                .kappa_mpa = kKappa_mpa}}}},
                  .prescribed = {}};
  const auto bottom = nodes_where(model.mesh, [](const Vec3& p) { return p.z() < 1e-9; });
  const auto top = nodes_where(model.mesh, [](const Vec3& p) { return p.z() > kLength_mm - 1e-9; });
  model.prescribed = [&](double share) {
    const Eigen::AngleAxisd turn(share * kTwist_rad_per_mm * kLength_mm, Vec3::UnitZ());
    RigidTransform motion_LL = RigidTransform::Identity();
    motion_LL.linear() = turn.toRotationMatrix();
    std::vector<fem::PrescribedDisplacement> all = fem::fix(bottom);
    const auto moved = fem::move_rigidly(top, model.mesh.nodes_L, motion_LL);
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
  return loads;
}

}  // namespace

Section verify_torsion(Extent extent, Progress& progress) {
  const EndLoads wanted = exact();
  const int cells = extent == Extent::kFull ? 4 : 2;
  Section section{
      .name = "torsion",
      .title = "Twisted column: Rivlin's torque and axial force",
      .text = fmt::format(
          "A circular column, 1 mm long and 1 mm in radius, of an incompressible neo-Hookean "
          "material (bulk over shear "
          "modulus {:.0g}) is twisted by {} rad between ends that keep their distance. Rivlin "
          "(Large "
          "elastic deformations of isotropic materials VI, 1949) found that every section turns "
          "rigidly, whatever the size of the twist; the ends need the torque pi mu tau a^4 / 2 = "
          "{:.5f} N mm and, which no linear "
          "theory knows, the axial force -pi mu tau^2 a^4 / 4 = {:.5f} N. Meshes of {} x {} cells "
          "in "
          "the section of each quarter.",
          kKappa_mpa, kTwist_rad_per_mm, wanted.torque_nmm, wanted.axial_n, cells, 2 * cells)};
  Table table{.title = "End loads over Rivlin's", .header = {"shape", "torque", "axial force"}};
  for (const mesh::ElementShape shape : kAllShapes) {
    const auto found = twist(shape, cells, progress);
    if (!found) {
      section.checks.push_back(not_measured(text_of(shape), found.error().message));
      continue;
    }
    const double torque = found->torque_nmm / wanted.torque_nmm;
    const double axial = found->axial_n / wanted.axial_n;
    table.rows.push_back(
        {text_of(shape), fmt::format("{:.4f}", torque), fmt::format("{:.4f}", axial)});
    // The chords of straight-sided shapes cut the rim: area and moment are short of the circle's.
    const double h = kRadius_mm / (2.0 * cells);
    const double tolerance = degree(shape) == 2 ? 0.5 * h * h : 2.0 * h * h;
    const char* const reason =
        degree(shape) == 2
            ? "curved sides follow the rim; half the square of a cell's share of the radius"
            : "chords cut the rim (the moment is short by about h^2) and linear shapes see "
              "the shear with an error of h^2: twice h^2";
    section.checks.push_back({.name = fmt::format("{}: torque over Rivlin's", text_of(shape)),
                              .measured = torque,
                              .expected = 1.0,
                              .tolerance = tolerance,
                              .reason = reason});
    section.checks.push_back({.name = fmt::format("{}: axial force over Rivlin's", text_of(shape)),
                              .measured = axial,
                              .expected = 1.0,
                              .tolerance = 2.0 * tolerance,
                              .reason = "as the torque; of second order in the twist, so that "
                                        "relative errors double"});
  }
  section.tables.push_back(std::move(table));
  return section;
}

}  // namespace lefort::verify
