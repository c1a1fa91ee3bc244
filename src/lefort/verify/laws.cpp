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

const char* name_of_test(Test test) {
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

/// A cube of 1 mm, so that forces [N] are nominal stresses [MPa].
CaseModel cube(const fem::Material& law, Test test, double amount) {
  CaseModel model{.mesh = mesh::make_box(mesh::ElementShape::kHex8, {1, 1, 1}, Vec3::Ones()),
                  .materials = {{0, law}},
                  .prescribed = {}};
  const auto& sets = model.mesh.node_sets;
  std::vector<fem::PrescribedDisplacement> prescribed;
  if (test == Test::kSimpleShear) {
    // y' = y + gamma x at all nodes.
    for (int c = 0; c < 3; ++c) {
      prescribe(sets.at("x0"), c, 0.0, prescribed);
      prescribe(sets.at("x1"), c, c == 1 ? amount : 0.0, prescribed);
    }
  } else {
    prescribe(sets.at("x0"), 0, 0.0, prescribed);
    prescribe(sets.at("y0"), 1, 0.0, prescribed);
    prescribe(sets.at("z0"), 2, 0.0, prescribed);
    prescribe(sets.at("x1"), 0, amount - 1.0, prescribed);
    if (test == Test::kEquibiaxial) prescribe(sets.at("y1"), 1, amount - 1.0, prescribed);
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

bool is_decoupled(const fem::Material& law) {
  return std::visit([]<class Law>(const Law&) { return fem::kIsDecoupled<Law>; }, law);
}

/// Rows, line and differences of one law.
struct LawResults {
  std::vector<std::string> row = {}, stress_row = {};
  report::PlotLine line = {};
  double from_limit = 0.0;  ///< From the incompressible form, over sigma/kappa.
};

/// Largest relative difference over all amounts of one test.
struct LawDifference {
  double max = 0.0;  ///< NaN if an amount has no solution.
  std::string failure = "";
};

void record_uniaxial(const fem::Material& law, double stretch, double found, double wanted,
                     LawResults& results) {
  results.stress_row.push_back(fmt::format("{:.4f} / {:.4f}", found, wanted));
  results.line.x.push_back(stretch);
  results.line.y.push_back(found);
  if (!is_decoupled(law)) return;
  const double limit = incompressible_uniaxial(law, stretch);
  const double true_stress = std::abs(limit) * stretch;
  results.from_limit = std::max(results.from_limit, std::abs(found - limit) / std::abs(limit) /
                                                        (true_stress / kLawKappa_mpa));
}

LawDifference compare_law(const fem::Material& law, Test test, LawResults& results,
                          Progress& progress) {
  LawDifference difference;
  const auto compare = [&](double amount) {
    const auto found = measured(law, test, amount, progress);
    if (!found) {
      difference.failure = fmt::format("at {}: {}", amount, found.error().message);
      difference.max = NAN;
      return;
    }
    const double wanted = expected(law, test, amount);
    difference.max = std::max(difference.max, std::abs(*found - wanted) / std::abs(wanted));
    if (test == Test::kUniaxial) record_uniaxial(law, amount, *found, wanted, results);
  };
  if (test == Test::kSimpleShear)
    for (const double gamma : kShears) compare(gamma);
  else
    for (const double stretch : kStretches) compare(stretch);
  return difference;
}

/// Runs all tests of one law and adds their checks.
LawResults run_law(const NamedLaw& one, Section& section, Progress& progress) {
  LawResults results{.row = {one.name}, .stress_row = {one.name}, .line = {.name = one.name}};
  for (const Test test : {Test::kUniaxial, Test::kEquibiaxial, Test::kSimpleShear}) {
    const LawDifference difference = compare_law(one.law, test, results, progress);
    results.row.push_back(fmt::format("{:.1e}", difference.max));
    const std::string name = fmt::format("{}: {}", one.name, name_of_test(test));
    if (!difference.failure.empty()) {
      section.checks.push_back(not_measured(name, difference.failure));
      continue;
    }
    section.checks.push_back(
        {.name = name,
         .measured = difference.max,
         .comparison = Comparison::kAtMost,
         .tolerance = 1e-8,
         .reason =
             "strain is uniform, so that only Newton's 1e-12 N remains, magnified by bulk over "
             "shear modulus, 1e3"});
  }
  if (is_decoupled(one.law))
    section.checks.push_back(
        {.name = fmt::format(
             "{}: uniaxial difference from the incompressible form, over sigma/kappa", one.name),
         .measured = results.from_limit,
         .comparison = Comparison::kAtMost,
         .tolerance = 2.0,
         .reason = "the volume changes by sigma/(3 kappa), and the stress by a power of the volume "
                   "that is below 6 for these laws"});
  return results;
}

Section laws_section() {
  return {.name = "laws",
          .title = "Material laws against closed forms",
          .text = fmt::format(
              "One cubic hexahedron (hex8) of every law is stretched along x with free sides, "
              "stretched along x and y with a free third direction, and sheared (y' = y + gamma "
              "x, all nodes prescribed). The force on its side x = 1 mm is the nominal stress. "
              "The expected values come from a second implementation of the law in principal "
              "stretches (Ogden, Non-Linear Elastic Deformations, chapter 7), with the free "
              "stretch found by bisection. For simple shear of anisotropic laws, W(gamma) was "
              "derived by hand. Decoupled laws have the bulk modulus {} MPa; shear moduli are "
              "about 1 MPa. The difference from the incompressible closed form is reported, too.",
              kLawKappa_mpa)};
}

}  // namespace

Section verify_laws(Extent /*extent*/, Progress& progress) {
  Section section = laws_section();
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
    LawResults results = run_law(one, section, progress);
    table.rows.push_back(std::move(results.row));
    if (results.stress_row.size() == stresses.header.size())
      stresses.rows.push_back(std::move(results.stress_row));
    plot.lines.push_back(std::move(results.line));
  }
  section.tables = {std::move(table), std::move(stresses)};
  section.plots.push_back(std::move(plot));
  return section;
}

}  // namespace lefort::verify
