/// \file
/// Inputs of an uncertain prediction are checked before samples are solved.
#include <lefort/pipeline/uncertainty/face_statistics.h>
#include <lefort/pipeline/uncertainty/uncertain_inputs.h>

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

namespace lefort::pipeline::test_uncertain_inputs {
namespace {

UncertainInput input_of(const std::string& name) {
  for (const InputParameter& parameter : input_parameters())
    if (name == parameter.name) return {.name = name, .parameter = &parameter, .source = "test"};
  return {};
}

TEST(CheckDesign, NamesTheFirstSampleOutOfRange) {
  const std::vector<UncertainInput> inputs{input_of("poisson"), input_of("elevation_margin_mm")};
  Eigen::MatrixXd points(3, 2);
  points << 0.40, 20.0, 0.45, 0.0, 0.495, 60.0;
  EXPECT_TRUE(check_design(inputs, points));
  for (const double bad : {-2.5, 60.5, std::numeric_limits<double>::quiet_NaN()}) {
    points(1, 1) = bad;
    const auto checked = check_design(inputs, points);
    ASSERT_FALSE(checked) << bad;
    EXPECT_EQ(checked.error().code, ErrorCode::kInvalidArgument);
    EXPECT_NE(checked.error().message.find("elevation_margin_mm: sample 1"), std::string::npos)
        << checked.error().message;
  }
}

/// Seven levels of a normal distribution reach 3.75 standard deviations; the quantile of 0.1 % is
/// at 3.09.
TEST(CheckDesign, LevelsBeyondTheQuantilesAreFound) {
  const uncertainty::Distribution margin{.mean = 20.0, .standard_deviation = 6.0};
  EXPECT_GT(uncertainty::quantile(margin, 1e-3), 0.0);
  const uncertainty::Distribution levels = uncertainty::gauss_levels(margin, 7);
  Eigen::MatrixXd points(7, 1);
  for (Index k = 0; k < 7; ++k) points(k, 0) = levels.values[std::size_t(k)];
  EXPECT_FALSE(check_design(std::vector{input_of("elevation_margin_mm")}, points));
}

TEST(StatisticsMemory, OfTooManySamplesIsAnErrorWithTheNumber) {
  EXPECT_LT(statistics_memory_gb(200, 60'000), 0.5);
  EXPECT_GT(statistics_memory_gb(20'000, 60'000), 15.0);
  EXPECT_TRUE(check_statistics_memory(200, 60'000, 8.0));
  const auto checked = check_statistics_memory(20'000, 60'000, 8.0);
  ASSERT_FALSE(checked);
  EXPECT_EQ(checked.error().code, ErrorCode::kOutOfMemory);
  EXPECT_NE(checked.error().message.find("20000 samples"), std::string::npos);
}

}  // namespace
}  // namespace lefort::pipeline::test_uncertain_inputs
