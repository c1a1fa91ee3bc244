// Error estimates from three meshes.
#include <lefort/verify/check_convergence_order.h>
#include <lefort/verify/refinement.h>

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace lefort::verify::test_refinement {
namespace {

TEST(Refinement, FindsOrderAndErrorOfAPowerLaw) {
  const auto value = [](double h) { return 3.0 - 0.4 * std::pow(h, 1.5); };
  const Refinement found = refinement_of({value(1.0), value(0.5), value(0.25)}, 1.5);
  EXPECT_NEAR(found.order, 1.5, 1e-12);
  EXPECT_NEAR(found.error, kRefinementSafety * (3.0 - value(0.25)), 1e-12);
}

TEST(Refinement, LimitsTheOrderToTheory) {
  const Refinement found = refinement_of({0.0, 1.0, 1.0 + 1.0 / 64.0}, 2.0);
  EXPECT_NEAR(found.order, 6.0, 1e-12);
  EXPECT_NEAR(found.error, kRefinementSafety / 64.0 / 3.0, 1e-12);
}

TEST(Refinement, UsesTheSpreadOfAlternatingValues) {
  const Refinement found = refinement_of({1.0, 0.9, 0.96}, 2.0);
  EXPECT_TRUE(std::isnan(found.order));
  EXPECT_NEAR(found.error, kRefinementSafety * 0.1, 1e-12);
}

TEST(Refinement, PredictsNothingIfDifferencesDoNotDecrease) {
  for (const auto& values : {std::array{0.0, 1.0, 2.0}, std::array{0.0, 1.0, 3.0}})
    EXPECT_TRUE(std::isnan(refinement_of(values, 2.0).error));
}

TEST(Refinement, PredictedErrorUsesTheLargerDifference) {
  // Errors of order 2 whose last difference is small by chance: the one before still counts.
  EXPECT_NEAR(predicted_error({0.0, 0.4, 0.4}, 2.0), kRefinementSafety * 0.1 / 3.0, 1e-12);
  EXPECT_NEAR(predicted_error({0.0, 0.4, 0.6}, 2.0), kRefinementSafety * 0.2 / 3.0, 1e-12);
  for (const double order : {0.0, -1.0, std::nan("")})
    EXPECT_TRUE(std::isnan(predicted_error({0.0, 0.4, 0.6}, order)));
}

/// A quantity that converges to nine tenths of the exact value must fail.
TEST(CheckConvergenceOrder, RejectsConvergenceToAWrongValue) {
  const auto checked = [](double limit) {
    Section section{.name = "x", .title = "", .text = ""};
    const std::vector<double> values{limit - 0.16, limit - 0.04, limit - 0.01};
    check_convergence_order("x", values, {.order_reason = "theory"}, section);
    return section;
  };
  EXPECT_TRUE(checked(1.0).passed());
  EXPECT_FALSE(checked(0.9).passed());
  ASSERT_EQ(checked(0.9).checks.size(), 2U);
  EXPECT_TRUE(checked(0.9).checks[0].passed());  // The order.
}

TEST(CheckConvergenceOrder, RejectsASlowOrder) {
  Section section{.name = "x", .title = "", .text = ""};
  const std::vector<double> values{0.6, 0.8, 0.9};
  check_convergence_order("x", values, {.order_reason = "theory"}, section);
  EXPECT_FALSE(section.checks[0].passed());
  EXPECT_TRUE(section.checks[1].passed());  // The difference is what that order predicts.
}

TEST(CheckDifference, RejectsAWrongLimitAndANegativeOrder) {
  const auto checked = [](double limit, double order) {
    Section section{.name = "x", .title = "", .text = ""};
    check_difference("x", {limit - 0.16, limit + 0.04, limit - 0.01}, order, {}, section);
    return section;
  };
  EXPECT_TRUE(checked(1.0, 2.0).passed());
  EXPECT_FALSE(checked(0.9, 2.0).passed());
  EXPECT_FALSE(checked(1.0, -0.5).passed());
  // An order above theory does not reduce the predicted error.
  EXPECT_EQ(checked(1.0, 7.0).checks[0].measured, checked(1.0, 2.0).checks[0].measured);
}

TEST(CheckErrorOrder, ComparesTheLastErrorWithThePredictedOne) {
  const auto checked = [](const std::vector<double>& errors) {
    Section section{.name = "x", .title = "", .text = ""};
    check_error_order("x", errors, {.order_reason = "theory"}, section);
    return section;
  };
  const Section good = checked({0.16, 0.04, 0.01});
  ASSERT_EQ(good.checks.size(), 2U);
  EXPECT_NEAR(good.checks[0].measured, 2.0, 1e-12);
  EXPECT_NEAR(good.checks[1].measured, 1.0 / kRefinementSafety, 1e-12);
  EXPECT_TRUE(good.passed());
  const Section stuck = checked({0.16, 0.04, 0.03});
  EXPECT_FALSE(stuck.checks[0].passed());
  EXPECT_FALSE(stuck.checks[1].passed());
  // A constant but slow order fails only the check of the order.
  const Section slow = checked({0.04, 0.02, 0.01});
  EXPECT_FALSE(slow.checks[0].passed());
  EXPECT_TRUE(slow.checks[1].passed());
  EXPECT_EQ(checked({0.04, 0.01}).checks.size(), 1U);
}

}  // namespace
}  // namespace lefort::verify::test_refinement
