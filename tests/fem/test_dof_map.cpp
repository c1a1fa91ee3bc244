#include <lefort/core/check.h>
#include <lefort/fem/assembly/dof_map.h>

#include <gtest/gtest.h>

#include <limits>

namespace lefort::fem::test_dof_map {
namespace {

const std::vector<PrescribedDisplacement> kSome{{.node = 1, .component = 2, .displacement_mm = 7},
                                                {.node = 0, .component = 0, .displacement_mm = 5}};

TEST(DofMap, NumbersFreeComponentsWithoutGaps) {
  const auto map = DofMap::build(2, kSome).value();
  EXPECT_EQ(map.node_count(), 2);
  EXPECT_EQ(map.free_count(), 4);
  const std::vector<std::int32_t> expected{-1, 0, 1, 2, 3, -1};
  for (Index all = 0; all < 6; ++all) EXPECT_EQ(map.free_number(all), expected[std::size_t(all)]);
}

TEST(DofMap, SplitsAndJoinsVectors) {
  const auto map = DofMap::build(2, kSome).value();
  VectorX all(6);
  all << 10, 11, 12, 13, 14, 15;
  EXPECT_EQ(map.free_part(all), Eigen::Vector4d(11, 12, 13, 14));
  VectorX joined(6);
  joined << 10, 1, 2, 3, 4, 15;
  EXPECT_EQ(map.with_free_part(all, Eigen::Vector4d(1, 2, 3, 4)), joined);
  VectorX moved(6);
  moved << 5, 11, 12, 13, 14, 7;
  EXPECT_EQ(map.with_prescribed(all, kSome), moved);
}

TEST(DofMap, AComponentPrescribedTwiceWithOneValueIsAccepted) {
  const std::vector<PrescribedDisplacement> twice{kSome[0], kSome[0]};
  EXPECT_EQ(DofMap::build(2, twice).value().free_count(), 5);
}

TEST(DofMap, RejectsMissingNodesAndContradictions) {
  const auto message_of = [](PrescribedDisplacement first, PrescribedDisplacement second) {
    const auto map = DofMap::build(2, std::vector{first, second});
    EXPECT_EQ(map.error().code, ErrorCode::kInvalidArgument);
    return map.error().message;
  };
  const PrescribedDisplacement good = kSome[0];
  EXPECT_EQ(message_of(good, {.node = 2}), "prescribed displacement: node is 2, must be 0 to 1");
  EXPECT_EQ(message_of(good, {.node = -1}), "prescribed displacement: node is -1, must be 0 to 1");
  EXPECT_EQ(message_of(good, {.node = 1, .component = 3}),
            "prescribed displacement of node 1: component is 3, must be 0 to 2");
  EXPECT_EQ(message_of(good, {.node = 1, .component = 2, .displacement_mm = 8}),
            "node 1 is moved by 7 mm and by 8 mm in component 2, must be one");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(message_of(good, {.node = 0, .component = 1, .displacement_mm = nan}),
            "prescribed displacement of node 0 is nan mm, must be finite");
}

TEST(DofMap, WritingAFreeComponentIsALogicError) {
  const auto map = DofMap::build(2, kSome).value();
  const std::vector<PrescribedDisplacement> other{{.node = 0, .component = 1}};
  EXPECT_THROW((void)map.with_prescribed(VectorX::Zero(6), other), LogicError);
  EXPECT_THROW((void)map.free_part(VectorX::Zero(5)), LogicError);
}

}  // namespace
}  // namespace lefort::fem::test_dof_map
