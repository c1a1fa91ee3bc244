#include <lefort/fem/assembly/element_state.h>
#include <lefort/fem/deformation.h>
#include <lefort/mesh/box_grid.h>
#include <lefort/verify/case_model.h>
#include <lefort/verify/cases.h>
#include <lefort/verify/shapes.h>

#include <fmt/format.h>

#include <algorithm>
#include <random>
#include <utility>

namespace lefort::verify {
namespace {

constexpr double kTolerance = 1e-9;
constexpr const char* kReason =
    "Newton stops at 1e-11 of the forces; the condition of the tangent (bulk over shear modulus) "
    "magnifies that by up to a hundred";

struct Patch {
  std::string name;
  mesh::VolumeMesh mesh;
};

/// Cubes of 1 mm with 3 or 4 cells per side and displaced inner corners.
std::vector<Patch> patches() {
  std::vector<Patch> all;
  const auto add = [&](std::string name, mesh::VolumeMesh mesh, int cells) {
    std::mt19937 random(20);
    const double max_shift_mm = 0.15 / cells;
    all.push_back({std::move(name), mesh::with_inner_nodes_moved(
                                        std::move(mesh), Vec3::Constant(max_shift_mm), random)});
  };
  for (const mesh::ElementShape shape : kAllShapes)
    add(text_of(shape), mesh::make_box(shape, {3, 3, 3}, Vec3::Ones()), 3);
  add("hex8 wedge6 pyramid5 tet4",
      mesh::make_mixed_box(mesh::BoxMix::kAllLinear, {4, 4, 4}, Vec3::Ones()), 4);
  add("hex20 wedge15", mesh::make_mixed_box(mesh::BoxMix::kHex20Wedge15, {3, 3, 3}, Vec3::Ones()),
      3);
  add("wedge15 tet10", mesh::make_mixed_box(mesh::BoxMix::kWedge15Tet10, {3, 3, 3}, Vec3::Ones()),
      3);
  return all;
}

/// Stretched by 30 %, sheared by up to 25 %, rotated; J = 1.08.
Mat3 affine_F() {
  Mat3 F;
  F << 1.3, 0.25, -0.1,  //
      -0.15, 0.9, 0.2,   //
      0.1, -0.05, 0.85;
  return F * std::cbrt(1.08 / F.determinant());
}

struct PatchErrors {
  double displacement = 0.0;  ///< Largest of any node, over the largest displacement.
  double stress = 0.0;        ///< Largest of any element, over the size of the stress.
};

Result<PatchErrors> run(const mesh::VolumeMesh& mesh, const fem::Material& law, const Mat3& F,
                        Progress& progress) {
  CaseModel model{.mesh = mesh, .materials = {{0, law}}, .prescribed = {}};
  VectorX exact(3 * mesh.node_count());
  for (Index n = 0; n < mesh.node_count(); ++n)
    exact.segment<3>(3 * n) = (F - Mat3::Identity()) * mesh.nodes_L[std::size_t(n)];
  std::vector<fem::PrescribedDisplacement> prescribed;
  for (const std::int32_t node : mesh.node_sets.at("boundary"))
    for (int c = 0; c < 3; ++c) prescribe({node}, c, exact[3 * Index(node) + c], prescribed);
  model.prescribed = in_proportion(std::move(prescribed));
  LEFORT_TRY(const Equilibrium found,
             solve(model, {.increments = 2, .relative_tolerance = 1e-11}, progress));

  PatchErrors errors{.displacement = (found.u - exact).lpNorm<Eigen::Infinity>() /
                                     exact.lpNorm<Eigen::Infinity>()};
  const Mat3 sigma =
      fem::cauchy_stress(std::visit([&](const auto& one) { return one.stress(F); }, law), F);
  for (const fem::ElementState& state : fem::element_states(mesh, model.materials, found.u))
    errors.stress = std::max(errors.stress, (state.cauchy_mpa - sigma).norm() / sigma.norm());
  return errors;
}

}  // namespace

Section verify_patch(Extent /*extent*/, Progress& progress) {
  Section section{
      .name = "patch",
      .title = "Patch tests",
      .text =
          "The boundary of a cube of 3 (mixed: 3 or 4) cells per side moves by one affine map, "
          "with strains up to 30 %, shear and rotation. Inner nodes are first displaced by up to "
          "15 % of a cell. For all elements and any distortion, the inner nodes must follow the "
          "map and the stress must be uniform (Hughes, The Finite Element Method, section 3.9; "
          "here at finite strain). There are two laws: a compressible neo-Hookean one, and a "
          "decoupled one with bulk modulus 100 times the shear modulus and the volumetric "
          "averaging of each shape. Errors are relative to the largest displacement and to the "
          "norm of the "
          "Cauchy stress."};
  const fem::Material compressible = fem::NeoHookean{.mu_mpa = 0.7, .lambda_mpa = 1.3};
  const fem::Material decoupled = decoupled_neo_hookean(0.7, 70.0);
  Table table{.title = "Largest errors, relative",
              .header = {"elements", "law", "displacement", "stress"}};
  const std::vector<Patch> all = patches();
  double done = 0.0;
  for (const Patch& patch : all) {
    for (const bool is_decoupled : {false, true}) {
      const char* const law = is_decoupled ? "decoupled, averaged volume" : "neo-Hookean";
      const std::string name = fmt::format("{}, {}", patch.name, law);
      const auto errors =
          run(patch.mesh, is_decoupled ? decoupled : compressible, affine_F(), progress);
      if (!errors) {
        section.checks.push_back(not_measured(name, errors.error().message));
        continue;
      }
      table.rows.push_back({patch.name, law, fmt::format("{:.1e}", errors->displacement),
                            fmt::format("{:.1e}", errors->stress)});
      for (const auto& [what, error] :
           {std::pair{"displacement", errors->displacement}, std::pair{"stress", errors->stress}})
        section.checks.push_back({.name = fmt::format("{}: {}", name, what),
                                  .measured = error,
                                  .comparison = Comparison::kAtMost,
                                  .tolerance = kTolerance,
                                  .reason = kReason});
    }
    progress.report(++done / double(all.size()));
  }
  section.tables.push_back(std::move(table));
  return section;
}

}  // namespace lefort::verify
