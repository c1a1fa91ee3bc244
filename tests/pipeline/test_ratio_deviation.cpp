/// \file
/// Reasons for ratios of soft tissue to bone outside their published ranges.
#include <lefort/pipeline/predict/ratio_deviation.h>
#include <lefort/pipeline/predict/ratio_results.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

namespace lefort::pipeline {
namespace {

using compare::SoftTissueRatio;

/// Whether there is one reason for each part, in order.
bool are(const std::vector<std::string>& reasons, const std::vector<std::string>& parts) {
  return std::equal(reasons.begin(), reasons.end(), parts.begin(), parts.end(),
                    [](const std::string& reason, const std::string& part) {
                      return reason.find(part) != std::string::npos;
                    });
}

SoftTissueRatio ratio_of(const std::string& soft, double ratio, double low, double high) {
  return {.segment = "maxilla",
          .procedure = compare::Procedure::kLeFort1,
          .direction = compare::Direction::kAdvancement,
          .is_main_axis = true,
          .soft = soft,
          .hard = "A",
          .soft_mm = 5.0 * ratio,
          .hard_mm = 5.0,
          .published = compare::PublishedRange{.low = low, .high = high, .sources = {}}};
}

std::vector<ExplainedRatio> by_interfaces(const SoftTissueRatio& ratio, double held,
                                          double contact) {
  SoftTissueRatio one = ratio, other = ratio;
  one.soft_mm = held * ratio.hard_mm;
  other.soft_mm = contact * ratio.hard_mm;
  return with_interfaces(std::array{ratio}, std::array{one}, std::array{other});
}

TEST(DeviationReasons, AreEmptyInsideTheRangeAndWithoutOne) {
  EXPECT_TRUE(deviation_reasons({ratio_of("A'", 0.6, 0.4, 0.7)}).empty());
  SoftTissueRatio unknown = ratio_of("A'", 0.6, 0.4, 0.7);
  unknown.published.reset();
  EXPECT_TRUE(deviation_reasons({unknown}).empty());
}

TEST(DeviationReasons, SayWhetherTheInterfaceExplainsTheDeviation) {
  const auto explained = by_interfaces(ratio_of("A'", 0.9, 0.4, 0.7), 0.95, 0.65);
  EXPECT_TRUE(are(deviation_reasons(explained.front()),
                  {"0.65 by contact and 0.95 with attached tissue, so that the "
                   "interface explains it"}));
  const auto still_outside = by_interfaces(ratio_of("A'", 0.9, 0.4, 0.7), 0.95, 0.75);
  EXPECT_TRUE(are(deviation_reasons(still_outside.front()), {"Not the interface"}));
}

TEST(DeviationReasons, ANarrowRangeBetweenTheInterfacesIsExplained) {
  const auto explained = by_interfaces(ratio_of("A'", 0.9, 0.5, 0.52), 0.9, 0.3);
  EXPECT_TRUE(are(deviation_reasons(explained.front()), {"explains it"}));
}

TEST(DeviationReasons, NameTheEndOfTheScanWithinItsRangeOnly) {
  const std::vector<plan::Landmark> landmarks{{"A'", Vec3(0, 0, 0)}};
  for (const double z_mm : {24.0, 26.0}) {
    std::vector<ExplainedRatio> one{{ratio_of("A'", 0.9, 0.4, 0.7)}};
    measure_scan_boundary(one, landmarks, std::array{Vec3(0, 0, -z_mm), Vec3(90, 0, -z_mm)});
    EXPECT_EQ(one.front().scan_boundary_mm.has_value(), z_mm < kNearScanBoundary_mm);
    EXPECT_TRUE(are(deviation_reasons(one.front()),
                    {z_mm < kNearScanBoundary_mm ? "ends 24 mm" : "No reason"}));
  }
}

TEST(DeviationReasons, NameWhatTheModelLacksAndASingleMean) {
  EXPECT_TRUE(
      are(deviation_reasons({ratio_of("Prn", 0.9, 0.17, 0.17)}), {"cartilage", "one mean"}));
  EXPECT_TRUE(are(deviation_reasons({ratio_of("Ls", 0.2, 0.5, 0.95)}), {"muscle tone"}));
  SoftTissueRatio beside = ratio_of("A'", 0.9, 0.4, 0.7);
  beside.is_main_axis = false;
  EXPECT_TRUE(are(deviation_reasons({beside}), {"Not the main axis"}));
}

TEST(RatioTables, ListDeviationsWithTheirReasons) {
  const std::vector<ExplainedRatio> ratios{{ratio_of("A'", 0.6, 0.4, 0.7)},
                                           {ratio_of("Ls", 0.2, 0.5, 0.95)}};
  const auto tables = ratio_tables(ratios);
  ASSERT_EQ(tables.size(), 2U);
  ASSERT_EQ(tables[1].rows.size(), 1U);
  EXPECT_NE(tables[1].rows[0][0].find("Ls : A"), std::string::npos);
  EXPECT_TRUE(ratios_json(ratios)[0]["deviation_reasons"].empty());
  EXPECT_EQ(ratios_json(ratios)[1]["deviation_reasons"].size(), 1U);
}

}  // namespace
}  // namespace lefort::pipeline
