#include <lefort/plan/check_volumes.h>

#include <gtest/gtest.h>

namespace lefort::plan::test_check_volumes {
namespace {

TEST(CheckVolumes, PartsMustAddUpToTheWhole) {
  EXPECT_TRUE(check_volumes("cut", 1000.0, {400.0, 600.0, 0.0}));
  EXPECT_TRUE(check_volumes("cut", 1000.0, {400.0, 600.9, 0.0}));
  const auto lost = check_volumes("osteotomy of 'chin'", 1000.0, {400.0, 598.0, 0.0});
  ASSERT_FALSE(lost);
  EXPECT_EQ(lost.error().code, ErrorCode::kMeshingFailed);
  EXPECT_NE(lost.error().message.find("osteotomy of 'chin': the parts hold 0.9980 ml"),
            std::string::npos)
      << lost.error().message;
  EXPECT_FALSE(check_volumes("cut", 1000.0, {400.0, 602.0, 0.0}));
}

TEST(CheckVolumes, SmallPartMustNotVanishInALargeWhole) {
  EXPECT_FALSE(check_volumes("cut", 8e5, {8e5 - 300.0 + 200.0, 300.0}));
  EXPECT_TRUE(check_volumes("cut", 8e5, {8e5 - 300.0 + 2.0, 300.0}));
}

}  // namespace
}  // namespace lefort::plan::test_check_volumes
