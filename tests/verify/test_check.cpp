// Acceptance criteria and the report of failures.
#include <lefort/verify/verification_report.h>

#include <gtest/gtest.h>

#include <cmath>

namespace lefort::verify::test_check {
namespace {

TEST(Check, FailsOnTheSideOfTheComparison) {
  Check check{.name = "x", .measured = 2.3, .expected = 2.0, .tolerance = 0.2};
  EXPECT_FALSE(check.passed());
  check.comparison = Comparison::kAtLeast;
  EXPECT_TRUE(check.passed());
  check.comparison = Comparison::kAtMost;
  EXPECT_FALSE(check.passed());
  check.measured = 1.9;
  for (const Comparison comparison :
       {Comparison::kNear, Comparison::kAtLeast, Comparison::kAtMost}) {
    check.comparison = comparison;
    EXPECT_TRUE(check.passed());
  }
}

TEST(Check, FailsWithoutAMeasurement) {
  for (const Comparison comparison : {Comparison::kNear, Comparison::kAtLeast, Comparison::kAtMost})
    EXPECT_FALSE(
        (Check{.name = "x", .measured = NAN, .comparison = comparison, .tolerance = 1e9}.passed()));
  EXPECT_FALSE(not_measured("x", "the solver stopped").passed());
  // A known failure is reported and accepted.
  const Check known{.name = "x", .measured = 2.0, .expected = 1.0, .known_failure = "coarse"};
  EXPECT_FALSE(known.passed());
  EXPECT_TRUE(known.is_acceptable());
  EXPECT_TRUE((Section{.name = "n", .title = "", .text = "", .checks = {known}}.passed()));
  EXPECT_FALSE((Section{.name = "empty", .title = "", .text = ""}.passed()));
}

TEST(VerificationReport, ReportsFailuresAndTheirCause) {
  Section section{.name = "one", .title = "One case", .text = "What it is."};
  section.checks.push_back({.name = "width",
                            .measured = 2.5,
                            .expected = 2.0,
                            .tolerance = 0.1,
                            .unit = "mm",
                            .reason = "a | in a cell"});
  section.checks.push_back(not_measured("height", "no equilibrium"));
  section.plots.push_back({.title = "Plot"});
  const auto files = verification_report(std::vector{section}, "lefort verify");
  ASSERT_EQ(files.size(), 2U);
  EXPECT_EQ(files[0].name, "verification.md");
  EXPECT_NE(files[0].content.find("| width | 2.5 mm | 2 mm ± 0.1 | a \\| in a cell | **failed** |"),
            std::string::npos)
      << files[0].content;
  EXPECT_NE(files[0].content.find("| height | no equilibrium |"), std::string::npos);
  EXPECT_NE(files[0].content.find("| One case | 2 | 0 |"), std::string::npos);
  EXPECT_NE(files[0].content.find("![Plot](verification-one-1.svg)"), std::string::npos);
  EXPECT_EQ(files[1].name, "verification-one-1.svg");
  EXPECT_EQ(files[1].content.rfind("<svg", 0), 0U);
  EXPECT_EQ(files[1].content.find("var("), std::string::npos);  // Not all viewers support it.
}

}  // namespace
}  // namespace lefort::verify::test_check
