// The short form of the suite, with one test per case.
#include <lefort/verify/run_suite.h>
#include <lefort/verify/verification_report.h>

#include <gtest/gtest.h>

#include <string>

namespace lefort::verify::test_suite {
namespace {

class Suite : public testing::TestWithParam<Case> {};

TEST_P(Suite, PassesEveryCheckOfTheShortForm) {
  const Section section = GetParam().run(Extent::kShort, Progress::none());
  EXPECT_EQ(section.name, GetParam().name);
  EXPECT_FALSE(section.checks.empty());
  for (const Check& check : section.checks) {
    EXPECT_TRUE(check.is_acceptable()) << check.name << ": " << text_of(check);
    EXPECT_FALSE(check.reason.empty()) << check.name;
  }
  for (const Table& table : section.tables)
    for (const auto& row : table.rows) EXPECT_EQ(row.size(), table.header.size()) << table.title;
}

std::string name_of(const testing::TestParamInfo<Case>& one) {
  std::string name = one.param.name;
  for (char& c : name)
    if (c == '-') c = '_';
  return name;
}

INSTANTIATE_TEST_SUITE_P(Cases, Suite, testing::ValuesIn(all_cases().begin(), all_cases().end()),
                         name_of);

TEST(RunSuite, RejectsAnUnknownCaseByName) {
  const auto sections = run_suite({.only = "pach"}, Progress::none());
  ASSERT_FALSE(sections.has_value());
  EXPECT_EQ(sections.error().code, ErrorCode::kInvalidArgument);
  EXPECT_NE(sections.error().message.find("'pach'"), std::string::npos);
}

TEST(RunSuite, GivesTheSameReportTwice) {
  const auto report = [] {
    const auto sections = run_suite({.only = "newton"}, Progress::none());
    return verification_report(sections.value(), "lefort verify").front().content;
  };
  EXPECT_EQ(report(), report());
}

}  // namespace
}  // namespace lefort::verify::test_suite
