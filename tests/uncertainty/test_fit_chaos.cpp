#include <lefort/uncertainty/fit_chaos.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "example_models.h"

namespace lefort::uncertainty {
namespace {

/// A basis with its values at the points of a run.
struct Prepared {
  ChaosBasis basis;
  Eigen::MatrixXd values;
};

Prepared prepare(const ModelRun& run, const BasisOptions& options = {}) {
  ChaosBasis basis = make_basis(run.inputs, options);
  Eigen::MatrixXd values = evaluate(basis, run.points);
  return {std::move(basis), std::move(values)};
}

}  // namespace

TEST(ChaosBasis, FullSetsHaveBinomialSize) {
  const ChaosBasis basis =
      make_basis(std::vector<ChaosInput>(4, {normal(0.0, 1.0)}), {.max_degree = 3});
  EXPECT_EQ(basis.candidate_ends.front(), 5);  // (4 + 1)! / (4! 1!)
  EXPECT_EQ(basis.candidate_ends.back(), 35);  // (4 + 3)! / (4! 3!)
  EXPECT_EQ(*std::max_element(basis.terms[0].begin(), basis.terms[0].end()), 0);
}

TEST(ChaosBasis, DegreesOfAnInputAreLimited) {
  const ChaosBasis basis =
      make_basis({{normal(0.0, 1.0), 1}, {normal(0.0, 1.0)}}, {.max_degree = 4});
  for (const ChaosTerm& term : basis.terms) EXPECT_LE(term[0], 1);
}

TEST(ChaosBasis, ManyInputsHaveAtLeastTheLinearSet) {
  const ChaosBasis basis =
      make_basis(std::vector<ChaosInput>(60, {normal(0.0, 1.0)}), {.max_terms = 20});
  EXPECT_EQ(basis.terms.size(), 61u);
}

TEST(FitChaos, APolynomialIsFoundExactly) {
  const ModelRun made = run({uniform(0.0, 2.0), normal(1.0, 3.0), uniform(-1.0, 1.0)}, 60,
                            [](const VectorX& x) { return 2.0 + x[0] - 0.5 * x[1] * x[2]; });
  const Prepared prepared = prepare(made);
  const ChaosFit fit = fit_chaos(prepared.values, prepared.basis.candidate_ends, made.values);
  EXPECT_NEAR(fit.q2, 1.0, 1e-12);
  // x1 x2 = (1 + 3 z) x2: one product and one linear term.
  EXPECT_LE(fit.terms.size(), 6u);
  EXPECT_NEAR(fit.coefficients[0], 3.0, 1e-10);
}

/// The shortcut is the same as fitting without each point in turn.
TEST(FitChaos, LeaveOneOutErrorIsThatOfFitsWithoutEachPoint) {
  ModelRun made = run({uniform(-1.0, 1.0), uniform(-1.0, 1.0)}, 40,
                      [](const VectorX& x) { return std::exp(x[0]) + 0.3 * x[1]; });
  const ChaosBasis basis = make_basis(made.inputs, {.max_degree = 1});
  const Eigen::MatrixXd a = evaluate(basis, made.points);
  const ChaosFit fit = fit_chaos(a, basis.candidate_ends, made.values);
  ASSERT_EQ(fit.terms.size(), 3u);
  double sum = 0.0;
  for (Index out = 0; out < 40; ++out) {
    std::vector<Index> rows;
    for (Index i = 0; i < 40; ++i)
      if (i != out) rows.push_back(i);
    const VectorX c = refit(a, fit, made.values, rows);
    double predicted = 0.0;
    for (std::size_t k = 0; k < 3; ++k) predicted += c[Index(k)] * a(out, fit.terms[k]);
    sum += std::pow(predicted - made.values[out], 2);
  }
  const Eigen::MatrixXd c = a.transpose() * a;
  const double correction = 40.0 / 37.0 * (1.0 + c.inverse().trace());
  const double variance = (made.values.array() - made.values.mean()).square().sum() / 39.0;
  EXPECT_NEAR(fit.q2, 1.0 - correction * sum / 40.0 / variance, 1e-10);
}

TEST(FitChaos, NoiseIsNotFitted) {
  std::mt19937_64 bits(3);
  const ModelRun made = run(std::vector<Distribution>(8, uniform(0.0, 1.0)), 100,
                            [&](const VectorX&) { return double(bits() % 1000); });
  const Prepared prepared = prepare(made, {.max_degree = 3});
  const ChaosFit fit = fit_chaos(prepared.values, prepared.basis.candidate_ends, made.values);
  const VectorX errors = cross_validate(prepared.values, prepared.basis.candidate_ends,
                                        fit.candidate, made.values, 10);
  const double q2 =
      1.0 - errors.squaredNorm() / (made.values.array() - made.values.mean()).square().sum();
  EXPECT_LT(q2, 0.1);
}

TEST(FitChaos, AConstantNeedsOneTerm) {
  const ModelRun made = run({uniform(0.0, 1.0)}, 30, [](const VectorX&) { return 4.0; });
  const Prepared prepared = prepare(made);
  const ChaosFit fit = fit_chaos(prepared.values, prepared.basis.candidate_ends, made.values);
  EXPECT_EQ(fit.terms, std::vector<Index>{0});
  EXPECT_NEAR(fit.coefficients[0], 4.0, 1e-12);
}

TEST(FitChaos, CrossValidatedErrorIsThatOfNewPoints) {
  const ModelRun made = run(ishigami_inputs(), 200, ishigami);
  const Prepared prepared = prepare(made);
  const ChaosFit fit = fit_chaos(prepared.values, prepared.basis.candidate_ends, made.values);
  EXPECT_GT(fit.q2, 0.99);
  const VectorX errors = cross_validate(prepared.values, prepared.basis.candidate_ends,
                                        fit.candidate, made.values, 10);
  const ModelRun fresh = run(ishigami_inputs(), 400, ishigami, 99);
  const Eigen::MatrixXd at = evaluate(prepared.basis, fresh.points);
  VectorX predicted = VectorX::Zero(400);
  for (std::size_t k = 0; k < fit.terms.size(); ++k)
    predicted += fit.coefficients[Index(k)] * at.col(fit.terms[k]);
  const double of_new = (predicted - fresh.values).squaredNorm() / 400.0;
  const double variance = 13.8446;
  EXPECT_LT(of_new / variance, 0.01);
  EXPECT_LT(errors.squaredNorm() / 200.0 / variance, 0.05);
}

}  // namespace lefort::uncertainty
