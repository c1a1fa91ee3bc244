#include <lefort/mesh/box_grid.h>
#include <lefort/verify/case_model.h>
#include <lefort/verify/cases.h>
#include <lefort/verify/example_laws.h>
#include <lefort/verify/reference_laws.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace lefort::verify {
namespace {

constexpr double kStretches[] = {0.6, 0.8, 1.2, 1.6, 2.0};
constexpr double kShears[] = {0.2, 0.6, 1.0};
constexpr double kLawKappa_mpa = 1000.0;

enum class Test { kUniaxial, kEquibiaxial, kSimpleShear };

const char* text_of(Test test) {
  switch (test) {
    case Test::kUniaxial:
      return "uniaxial";
    case Test::kEquibiaxial:
      return "equibiaxial";
    case Test::kSimpleShear:
      return "simple shear";
  }
  return "";
}

/// One cube of 1 mm, so that forces [N] are nominal stresses [MPa].
CaseModel cube(const fem::Material& law, Test test, double amount) {
  CaseModel model{.mesh = mesh::make_box(mesh::ElementShape::kHex8, {1, 1, 1}, Vec3::Ones()),
                  .materials = {{0, law}},
                  .prescribed = {}};
  const auto& sets = model.mesh.node_sets;
  std::vector<fem::PrescribedDisplacement> prescribed;
  if (test == Test::kSimpleShear) {
    // y' = y + gamma x, of all nodes.
    for (int c = 0; c < 3; ++c) {
      hold(sets.at("x0"), c, 0.0, prescribed);
      hold(sets.at("x1"), c, c == 1 ? amount : 0.0, prescribed);
    }
  } else {
    hold(sets.at("x0"), 0, 0.0, prescribed);
    hold(sets.at("y0"), 1, 0.0, prescribed);
    hold(sets.at("z0"), 2, 0.0, prescribed);
    hold(sets.at("x1"), 0, amount - 1.0, prescribed);
    if (test == Test::kEquibiaxial) hold(sets.at("y1"), 1, amount - 1.0, prescribed);
  }
  model.prescribed = in_proportion(std::move(prescribed));
  return model;
}

double expected(const fem::Material& law, Test test, double amount) {
  switch (test) {
    case Test::kUniaxial:
      return uniaxial(law, amount).stress_mpa;
    case Test::kEquibiaxial:
      return equibiaxial(law, amount).stress_mpa;
    case Test::kSimpleShear:
      return simple_shear_stress(law, amount);
  }
  return NAN;
}

/// The force on the side x1: along x, in simple shear along y.
Result<double> measured(const fem::Material& law, Test test, double amount, Progress& progress) {
  const CaseModel model = cube(law, test, amount);
  LEFORT_TRY(const Equilibrium found,
             solve(model, {.increments = 4, .absolute_tolerance_n = 1e-12}, progress));
  return sum_over(model.mesh.node_sets.at("x1"),
                  found.reaction_n)[test == Test::kSimpleShear ? 1 : 0];
}

bool is_split(const fem::Material& law) {
  return std::visit([]<class Law>(const Law&) { return fem::kIsDecoupled<Law>; }, law);
}

}  // namespace

Section verify_laws(Extent /*extent*/, Progress& progress) {
  Section section{
      .name = "laws",
      .title = "Material laws against closed forms",
      .text = fmt::format(
          "One cubic hexahedron (hex8) of every law is stretched along x with free sides, along x "
          "and y with a free "
          "third, and sheared (y' = y + gamma x, all nodes held). The force on its side x = 1 mm "
          "is the "
          "nominal stress. Expected: the law written a second time in principal stretches (Ogden, "
          "Non-Linear Elastic Deformations, chapter 7), the free stretch found by bisection; "
          "simple shear of anisotropic laws "
          "by hand from W(gamma). Split laws have the bulk modulus {} MPa, shear moduli are about "
          "1 MPa; how far they "
          "are from the incompressible closed form is told, too.",
          kLawKappa_mpa)};
  Table table{
      .title = "Largest relative difference over all stretches (0.6 to 2) or shears (0.2 to 1)",
      .header = {"law", "uniaxial", "equibiaxial", "simple shear"}};
  Table stresses{.title = "Nominal stress in uniaxial stretch: measured / closed form [MPa]",
                 .header = {"law"}};
  for (const double s : kStretches) stresses.header.push_back(fmt::format("{}", s));
  report::LinePlot plot{.title = "Uniaxial stretch: nominal stress, measured",
                        .x_label = "stretch",
                        .y_label = "nominal stress [MPa]"};
  for (const NamedLaw& one : example_laws(kLawKappa_mpa)) {
    std::vector<std::string> row{one.name};
    std::vector<std::string> stress_row{one.name};
    report::PlotLine line{.name = one.name};
    double from_limit = 0.0;  // In units of what kappa predicts.
    for (const Test test : {Test::kUniaxial, Test::kEquibiaxial, Test::kSimpleShear}) {
      double worst = 0.0;
      std::string failure;
      const auto look = [&](double amount) {
        const auto found = measured(one.law, test, amount, progress);
        if (!found) {
          failure = fmt::format("at {}: {}", amount, found.error().message);
          worst = NAN;
          return;
        }
        const double wanted = expected(one.law, test, amount);
        worst = std::max(worst, std::abs(*found - wanted) / std::abs(wanted));
        if (test != Test::kUniaxial) return;
        stress_row.push_back(fmt::format("{:.4f} / {:.4f}", *found, wanted));
        line.x.push_back(amount);
        line.y.push_back(*found);
        if (!is_split(one.law)) return;
        const double limit = incompressible_uniaxial(one.law, amount);
        const double true_stress = std::abs(limit) * amount;
        from_limit = std::max(
            from_limit, std::abs(*found - limit) / std::abs(limit) / (true_stress / kLawKappa_mpa));
      };
      if (test == Test::kSimpleShear)
        for (const double gamma : kShears) look(gamma);
      else
        for (const double s : kStretches) look(s);
      row.push_back(fmt::format("{:.1e}", worst));
      const std::string name = fmt::format("{}: {}", one.name, text_of(test));
      if (!failure.empty()) {
        section.checks.push_back(not_measured(name, failure));
        continue;
      }
      section.checks.push_back(
          {.name = name,
           .measured = worst,
           .comparison = Comparison::kAtMost,
           .tolerance = 1e-8,
           .reason =
               "strain is uniform, so that only Newton's 1e-12 N remains, magnified by bulk over "
               "shear modulus, 1e3"});
    }
    if (is_split(one.law))
      section.checks.push_back(
          {.name = fmt::format(
               "{}: uniaxial difference from the incompressible form, over sigma/kappa", one.name),
           .measured = from_limit,
           .comparison = Comparison::kAtMost,
           .tolerance = 2.0,
           .reason =
               "the volume changes by sigma/(3 kappa), and the stress by a power of the volume "
               "that is below 6 for these laws"});
    table.rows.push_back(std::move(row));
    if (stress_row.size() == stresses.header.size()) stresses.rows.push_back(std::move(stress_row));
    plot.lines.push_back(std::move(line));
  }
  section.tables = {std::move(table), std::move(stresses)};
  section.plots.push_back(std::move(plot));
  return section;
}

}  // namespace lefort::verify
