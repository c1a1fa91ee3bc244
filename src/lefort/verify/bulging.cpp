#include <lefort/mesh/box_grid.h>
#include <lefort/verify/case_model.h>
#include <lefort/verify/cases.h>
#include <lefort/verify/shapes.h>

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace lefort::verify {
namespace {

constexpr double kHalf_mm = 1.0;
constexpr double kCompression = 0.2;
constexpr double kMu_mpa = 1.0;
constexpr double kPoisson = 0.499;

struct Bulge {
  double force_n = 0.0;   ///< On the plate, of the eighth.
  double bulge_mm = 0.0;  ///< How far the middle of a side moves out.
};

/// An eighth of the cube between plates it sticks to.
Result<Bulge> compress(mesh::ElementShape shape, int cells, Progress& progress) {
  const double kappa_mpa = 2.0 * kMu_mpa * (1.0 + kPoisson) / (3.0 * (1.0 - 2.0 * kPoisson));
  CaseModel model{.mesh = mesh::make_box(shape, {cells, cells, cells}, Vec3::Constant(kHalf_mm)),
                  .materials = {{0,
                                 fem::Split<fem::IsochoricNeoHookean>{
                                     .shear = {.mu_mpa = kMu_mpa},
                                     .volume = {.form = fem::VolumetricForm::kQuadraticLog,
                                                .kappa_mpa = kappa_mpa}}}},
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
  hold(top, 2, -kCompression * kHalf_mm, prescribed);
  model.prescribed = in_proportion(std::move(prescribed));
  LEFORT_TRY(const Equilibrium found,
             solve(model, {.increments = 2, .relative_tolerance = 1e-9}, progress));
  const auto middle = nodes_where(
      model.mesh, [](const Vec3& p) { return (p - Vec3(kHalf_mm, 0.0, 0.0)).norm() < 1e-9; });
  return Bulge{.force_n = -sum_over(top, found.reaction_n).z(),
               .bulge_mm = found.u[3 * Index(middle.at(0))]};
}

}  // namespace

Section verify_bulging(Extent extent, Progress& progress) {
  const bool full = extent == Extent::kFull;
  const int cells = full ? 8 : 4;
  const int finest = full ? 16 : 8;
  Section section{
      .name = "bulging",
      .title = "Nearly incompressible block between sticking plates",
      .text = fmt::format(
          "A cube of 2 mm (an eighth is meshed), nu = {}, is compressed by {:.0f} % between plates "
          "it sticks to; its sides bulge. "
          "Nothing closed is known; every shape, {} cells a side, is held against hex20 with {}.",
          kPoisson, 100.0 * kCompression, cells, finest)};
  const auto reference = compress(mesh::ElementShape::kHex20, finest, progress);
  if (!reference) {
    section.checks.push_back(not_measured("reference", reference.error().message));
    return section;
  }
  Table table{.title = fmt::format("Over the reference, {:.5f} N and {:.5f} mm", reference->force_n,
                                   reference->bulge_mm),
              .header = {"shape", "force", "bulge"}};
  for (const mesh::ElementShape shape : kAllShapes) {
    const auto found = compress(shape, cells, progress);
    if (!found) {
      section.checks.push_back(not_measured(text_of(shape), found.error().message));
      continue;
    }
    const double force = found->force_n / reference->force_n;
    const double bulge = found->bulge_mm / reference->bulge_mm;
    table.rows.push_back(
        {text_of(shape), fmt::format("{:.4f}", force), fmt::format("{:.4f}", bulge)});
    for (const auto& [what, ratio] : {std::pair{"force", force}, std::pair{"bulge", bulge}})
      section.checks.push_back(
          {.name = fmt::format("{}: {} over reference", text_of(shape), what),
           .measured = ratio,
           .expected = 1.0,
           .tolerance = 0.8 / cells,
           .reason =
               "stress is singular at the plates' edges, so that errors fall with h only; what "
               "locks is off by several times the force"});
  }
  section.tables.push_back(std::move(table));
  return section;
}

}  // namespace lefort::verify
