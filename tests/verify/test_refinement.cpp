// What three meshes tell of their error.
#include <lefort/verify/judge_refinement.h>
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

/// A quantity that locks at nine tenths of the truth must not pass, however well it settles.
TEST(JudgeRefinement, RefusesWhatSettlesOnAWrongValue) {
  const auto judged = [](double limit) {
    Section section{.name = "x", .title = "", .text = ""};
    const std::vector<double> values{limit - 0.16, limit - 0.04, limit - 0.01};
    judge_refinement("x", values, {.order_reason = "theory"}, section);
    return section;
  };
  EXPECT_TRUE(judged(1.0).passed());
  EXPECT_FALSE(judged(0.9).passed());
  ASSERT_EQ(judged(0.9).checks.size(), 2U);
  EXPECT_TRUE(judged(0.9).checks[0].passed());  // The order.
}

TEST(JudgeRefinement, RefusesASlowOrder) {
  Section section{.name = "x", .title = "", .text = ""};
  const std::vector<double> values{0.6, 0.8, 0.9};
  judge_refinement("x", values, {.order_reason = "theory"}, section);
  EXPECT_FALSE(section.checks[0].passed());
  EXPECT_TRUE(section.checks[1].passed());  // The difference is what that order predicts.
}

}  // namespace
}  // namespace lefort::verify
