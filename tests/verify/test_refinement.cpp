// What three meshes tell of their error.
#include <lefort/verify/check_convergence_order.h>
#include <lefort/verify/refinement.h>

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace lefort::verify {
namespace {

TEST(Refinement, FindsOrderErrorAndLimitOfAPowerOfTheCellsSize) {
  const auto value = [](double h) { return 3.0 - 0.4 * std::pow(h, 1.5); };
  const Refinement found = refinement_of({value(1.0), value(0.5), value(0.25)}, 1.5);
  EXPECT_NEAR(found.order, 1.5, 1e-12);
  EXPECT_NEAR(found.error, kRefinementSafety * (3.0 - value(0.25)), 1e-12);
}

TEST(Refinement, DoesNotTrustAnOrderBeyondTheory) {
  const Refinement found = refinement_of({0.0, 1.0, 1.0 + 1.0 / 64.0}, 2.0);
  EXPECT_NEAR(found.order, 6.0, 1e-12);
  EXPECT_NEAR(found.error, kRefinementSafety / 64.0 / 3.0, 1e-12);
}

TEST(Refinement, TakesTheSpreadWhereValuesGoToAndFro) {
  const Refinement found = refinement_of({1.0, 0.9, 0.96}, 2.0);
  EXPECT_TRUE(std::isnan(found.order));
  EXPECT_NEAR(found.error, kRefinementSafety * 0.1, 1e-12);
}

TEST(Refinement, PredictsNothingWhereDifferencesDoNotFall) {
  for (const auto& values : {std::array{0.0, 1.0, 2.0}, std::array{0.0, 1.0, 3.0}})
    EXPECT_TRUE(std::isnan(refinement_of(values, 2.0).error));
}

TEST(Refinement, ByANormsOrderTakesTheLargerDifference) {
  // Errors of order 2 whose last difference is small by chance: the one before still counts.
  EXPECT_NEAR(predicted_error({0.0, 0.4, 0.4}, 2.0), kRefinementSafety * 0.1 / 3.0, 1e-12);
  EXPECT_NEAR(predicted_error({0.0, 0.4, 0.6}, 2.0), kRefinementSafety * 0.2 / 3.0, 1e-12);
  for (const double order : {0.0, -1.0, std::nan("")})
    EXPECT_TRUE(std::isnan(predicted_error({0.0, 0.4, 0.6}, order)));
}

/// A quantity that locks at nine tenths of the truth must not pass, however well it settles.
TEST(CheckConvergenceOrder, RefusesWhatSettlesOnAWrongValue) {
  const auto judged = [](double limit) {
    Section section{.name = "x", .title = "", .text = ""};
    const std::vector<double> values{limit - 0.16, limit - 0.04, limit - 0.01};
    check_convergence_order("x", values, {.order_reason = "theory"}, section);
    return section;
  };
  EXPECT_TRUE(judged(1.0).passed());
  EXPECT_FALSE(judged(0.9).passed());
  ASSERT_EQ(judged(0.9).checks.size(), 2U);
  EXPECT_TRUE(judged(0.9).checks[0].passed());  // The order.
}

TEST(CheckConvergenceOrder, RefusesASlowOrder) {
  Section section{.name = "x", .title = "", .text = ""};
  const std::vector<double> values{0.6, 0.8, 0.9};
  check_convergence_order("x", values, {.order_reason = "theory"}, section);
  EXPECT_FALSE(section.checks[0].passed());
  EXPECT_TRUE(section.checks[1].passed());  // The difference is what that order predicts.
}

TEST(CheckDifference, RefusesAWrongLimitAndAMeasuredOrderThatIsNone) {
  const auto judged = [](double limit, double order) {
    Section section{.name = "x", .title = "", .text = ""};
    check_difference("x", {limit - 0.16, limit + 0.04, limit - 0.01}, order, {}, section);
    return section;
  };
  EXPECT_TRUE(judged(1.0, 2.0).passed());
  EXPECT_FALSE(judged(0.9, 2.0).passed());
  EXPECT_FALSE(judged(1.0, -0.5).passed());
  // An order above theory, which is chance, predicts no smaller error.
  EXPECT_EQ(judged(1.0, 7.0).checks[0].measured, judged(1.0, 2.0).checks[0].measured);
}

TEST(CheckErrorOrder, HoldsTheLastOneAgainstWhatTheTwoBeforePredict) {
  const auto judged = [](const std::vector<double>& errors) {
    Section section{.name = "x", .title = "", .text = ""};
    check_error_order("x", errors, {.order_reason = "theory"}, section);
    return section;
  };
  const Section good = judged({0.16, 0.04, 0.01});
  ASSERT_EQ(good.checks.size(), 2U);
  EXPECT_NEAR(good.checks[0].measured, 2.0, 1e-12);
  EXPECT_NEAR(good.checks[1].measured, 1.0 / kRefinementSafety, 1e-12);
  EXPECT_TRUE(good.passed());
  const Section stuck = judged({0.16, 0.04, 0.03});
  EXPECT_FALSE(stuck.checks[0].passed());
  EXPECT_FALSE(stuck.checks[1].passed());
  // Too slow an order that keeps on is refused as an order alone.
  const Section slow = judged({0.04, 0.02, 0.01});
  EXPECT_FALSE(slow.checks[0].passed());
  EXPECT_TRUE(slow.checks[1].passed());
  EXPECT_EQ(judged({0.04, 0.01}).checks.size(), 1U);
}

}  // namespace
}  // namespace lefort::verify
