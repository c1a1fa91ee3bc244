#include <lefort/mesh/box_grid.h>
#include <lefort/uncertainty/latin_hypercube.h>
#include <lefort/uncertainty/sobol_indices.h>
#include <lefort/verify/case_model.h>
#include <lefort/verify/cases.h>

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace lefort::verify {
namespace {

using std::numbers::pi;
using uncertainty::Distribution;
using uncertainty::DistributionKind;

constexpr double kBarWidth_mm = 10.0, kBarLength_mm = 40.0;
constexpr int kBarSamples = 100, kFunctionSamples = 400;
constexpr double kVarianceTolerance = 0.02, kIndexTolerance = 0.01;
constexpr double kQuantile95 = 1.6448536269514722;  // Of the standard normal distribution.

/// A bar between two plates that moves by `stretch_mm`, with free sides: one stress everywhere.
struct StretchedBar {
  double force_n = 0.0;
  std::vector<float> along_mm;  ///< Displacement of each node along the axis.
};

Result<StretchedBar> stretch(double young_mpa, double stretch_mm, Progress& progress) {
  LEFORT_TRY(const fem::LinearElastic law, fem::LinearElastic::from_young_poisson(young_mpa, 0.3));
  CaseModel model{.mesh = mesh::make_box(mesh::ElementShape::kHex8, {2, 2, 4},
                                         Vec3(kBarWidth_mm, kBarWidth_mm, kBarLength_mm)),
                  .materials = {{0, law}},
                  .prescribed = {}};
  const auto at = [&](int axis, double where) {
    return nodes_where(model.mesh, [=](const Vec3& p) { return std::abs(p[axis] - where) < 1e-9; });
  };
  const auto top = at(2, kBarLength_mm);
  std::vector<fem::PrescribedDisplacement> prescribed;
  for (int axis = 0; axis < 3; ++axis) prescribe(at(axis, 0.0), axis, 0.0, prescribed);
  prescribe(top, 2, stretch_mm, prescribed);
  model.prescribed = in_proportion(prescribed);
  LEFORT_TRY(const Equilibrium found, solve(model, {.relative_tolerance = 1e-10}, progress));
  StretchedBar bar{.force_n = sum_over(top, found.reaction_n).z(), .along_mm = {}};
  for (Index n = 0; n < model.mesh.node_count(); ++n)
    bar.along_mm.push_back(float(found.u[3 * n + 2]));
  return bar;
}

/// Random inputs, and their samples.
struct Design {
  std::vector<Distribution> distributions;
  std::vector<uncertainty::ChaosInput> inputs;
  Eigen::MatrixXd points;
};

Design make_design(std::vector<Distribution> distributions, Index count) {
  Design design{.distributions = std::move(distributions), .inputs = {}, .points = {}};
  for (const Distribution& one : design.distributions) design.inputs.push_back({one});
  design.points = uncertainty::points_at(
      design.distributions,
      uncertainty::nested_latin_hypercube(Index(design.distributions.size()), count, 1));
  return design;
}

uncertainty::FittedField fit(const Design& design, const std::vector<std::vector<float>>& samples) {
  return uncertainty::fit_field(design.inputs, design.points, samples,
                                std::vector<double>(samples.front().size(), 1.0),
                                {.variance_fraction = 1.0 - 1e-9})
      .value();  // Nothing stops it.
}

uncertainty::SobolIndices indices_of(const uncertainty::FittedField& fitted) {
  std::vector<std::vector<Index>> alone;
  for (std::size_t n = 0; n < fitted.surrogate.basis.inputs.size(); ++n)
    alone.push_back({Index(n)});
  const std::vector<double> weights(std::size_t(fitted.surrogate.mean.size()), 1.0);
  return uncertainty::sobol_indices(fitted.surrogate.basis, fitted.surrogate.coefficients,
                                    uncertainty::gram_of(fitted.surrogate.modes, weights), alone);
}

void check_variance(const std::string& name, double measured, double exact, Section& section) {
  section.checks.push_back({.name = name + ": variance over the exact one",
                            .measured = measured / exact,
                            .expected = 1.0,
                            .tolerance = kVarianceTolerance,
                            .reason = "required: 2 %"});
}

void check_index(const std::string& name, double measured, double exact, Section& section) {
  section.checks.push_back({.name = name,
                            .measured = measured,
                            .expected = exact,
                            .tolerance = kIndexTolerance,
                            .reason = "a hundredth of the variance"});
}

/// The force is the product of both inputs: F = E A d / L.
void check_bar_force(const Design& design, const std::vector<std::vector<float>>& forces,
                     Section& section) {
  const uncertainty::Moments e = uncertainty::moments_of(design.distributions[0]);
  const uncertainty::Moments d = uncertainty::moments_of(design.distributions[1]);
  const double k2 = std::pow(kBarWidth_mm * kBarWidth_mm / kBarLength_mm, 2);
  const double by_e = k2 * e.variance * d.mean * d.mean;
  const double by_d = k2 * d.variance * e.mean * e.mean;
  const double by_both = k2 * e.variance * d.variance;
  const double variance = by_e + by_d + by_both;
  const uncertainty::SobolIndices found = indices_of(fit(design, forces));
  check_variance("force of a bar with random stiffness and stretch", found.variance, variance,
                 section);
  check_index("force: first index of Young's modulus", found.first[0], by_e / variance, section);
  check_index("force: first index of the stretch", found.first[1], by_d / variance, section);
  check_index("force: total index of Young's modulus", found.total[0], (by_e + by_both) / variance,
              section);
}

/// The displacement is d z / L, whatever the stiffness is.
void check_bar_field(const Design& design, const std::vector<std::vector<float>>& fields,
                     Section& section) {
  const uncertainty::FittedField fitted = fit(design, fields);
  const Eigen::MatrixXd draws =
      uncertainty::points_at(design.distributions, uncertainty::nested_latin_hypercube(2, 4000, 2));
  const uncertainty::FieldBand band =
      uncertainty::field_band(fitted.surrogate, uncertainty::scores_at(fitted.surrogate, draws),
                              std::array{0.05, 0.95})
          .value();
  const double deviation_mm = design.distributions[1].standard_deviation;
  const std::size_t top = fields.front().size() - 1;  // The last node of a box.
  check_variance("displacement at the end", std::pow(band.standard_deviation[top], 2),
                 deviation_mm * deviation_mm, section);
  section.checks.push_back({.name = "displacement at the end: P95 - P5 over the exact width",
                            .measured = (band.quantiles[1][top] - band.quantiles[0][top]) /
                                        (2.0 * kQuantile95 * deviation_mm),
                            .expected = 1.0,
                            .tolerance = kVarianceTolerance,
                            .reason = "sampling error of 4000 draws: 1 %"});
  check_index("displacement: total index of Young's modulus", indices_of(fitted).total[0], 0.0,
              section);
}

void check_bar(Section& section, Progress& progress) {
  const Design design = make_design(
      {{.kind = DistributionKind::kLogNormal, .mean = 0.015, .standard_deviation = 0.004},
       {.kind = DistributionKind::kNormal, .mean = 1.0, .standard_deviation = 0.15}},
      kBarSamples);
  std::vector<std::vector<float>> forces, fields;
  for (Index i = 0; i < kBarSamples; ++i) {
    Result<StretchedBar> bar = stretch(design.points(i, 0), design.points(i, 1), progress);
    if (!bar) {
      section.checks.push_back(not_measured("bar", bar.error().message));
      return;
    }
    forces.push_back({float(bar->force_n)});
    fields.push_back(std::move(bar->along_mm));
  }
  check_bar_force(design, forces, section);
  check_bar_field(design, fields, section);
}

std::vector<std::vector<float>> evaluate_all(const Design& design,
                                             const std::function<double(const VectorX&)>& model) {
  std::vector<std::vector<float>> values;
  for (Index i = 0; i < design.points.rows(); ++i)
    values.push_back({float(model(design.points.row(i).transpose()))});
  return values;
}

/// u = sum a_i x_i + b x_1 x_2 of four distributions.
void check_linear_response(Section& section) {
  const Design design =
      make_design({{.kind = DistributionKind::kNormal, .mean = 2.0, .standard_deviation = 0.5},
                   {.kind = DistributionKind::kUniform, .low = -1.0, .high = 3.0},
                   {.kind = DistributionKind::kLogNormal, .mean = 3.0, .standard_deviation = 0.6},
                   {.kind = DistributionKind::kTriangular, .low = 0.0, .high = 2.0, .mode = 0.5}},
                  kBarSamples);
  const Eigen::Vector4d a(1.5, -2.0, 0.7, 3.0);
  constexpr double kProduct = 0.8;
  std::vector<uncertainty::Moments> m;
  for (const Distribution& one : design.distributions) m.push_back(uncertainty::moments_of(one));
  const double v0 = std::pow(a[0] + kProduct * m[1].mean, 2) * m[0].variance;
  const double v1 = std::pow(a[1] + kProduct * m[0].mean, 2) * m[1].variance;
  const double both = kProduct * kProduct * m[0].variance * m[1].variance;
  const double variance =
      v0 + v1 + both + a[2] * a[2] * m[2].variance + a[3] * a[3] * m[3].variance;
  const uncertainty::SobolIndices found = indices_of(fit(
      design,
      evaluate_all(design, [&](const VectorX& x) { return a.dot(x) + kProduct * x[0] * x[1]; })));
  check_variance("linear response with a product", found.variance, variance, section);
  check_index("linear response: total index of the first input", found.total[0],
              (v0 + both) / variance, section);
}

/// sin x1 + a sin^2 x2 + b x3^4 sin x1 \cite ishigami1990, with the closed forms of
/// \cite saltelli2008.
void check_ishigami(Section& section) {
  constexpr double kA = 7.0, kB = 0.1;
  const Design design = make_design(
      std::vector<Distribution>(3, {.kind = DistributionKind::kUniform, .low = -pi, .high = pi}),
      kFunctionSamples);
  const uncertainty::SobolIndices found =
      indices_of(fit(design, evaluate_all(design, [](const VectorX& x) {
                       return std::sin(x[0]) + kA * std::pow(std::sin(x[1]), 2) +
                              kB * std::pow(x[2], 4) * std::sin(x[0]);
                     })));
  const double v1 = 0.5 * std::pow(1.0 + kB * std::pow(pi, 4) / 5.0, 2), v2 = kA * kA / 8.0;
  const double v13 = kB * kB * std::pow(pi, 8) * (1.0 / 18.0 - 1.0 / 50.0);
  const double variance = v1 + v2 + v13;
  check_variance("Ishigami function", found.variance, variance, section);
  check_index("Ishigami function: first index of x1", found.first[0], v1 / variance, section);
  check_index("Ishigami function: first index of x2", found.first[1], v2 / variance, section);
  check_index("Ishigami function: first index of x3", found.first[2], 0.0, section);
  check_index("Ishigami function: total index of x1", found.total[0], (v1 + v13) / variance,
              section);
  check_index("Ishigami function: total index of x3", found.total[2], v13 / variance, section);
}

}  // namespace

Section verify_uncertainty(Extent, Progress& progress) {
  Section section{
      .name = "uncertainty",
      .title = "Uncertain inputs",
      .text = fmt::format(
          "Latin hypercube samples, polynomial chaos, Sobol indices and quantiles, with closed "
          "forms. A bar of linear elastic material with lognormal Young's modulus and normal "
          "stretch, "
          "{} solves: its force is the product of both, its displacement depends on the stretch "
          "alone. A linear response of four inputs with a product, {} samples. The Ishigami "
          "function, {} samples (Ishigami and Homma 1990).",
          kBarSamples, kBarSamples, kFunctionSamples)};
  check_bar(section, progress);
  check_linear_response(section);
  check_ishigami(section);
  return section;
}

}  // namespace lefort::verify
