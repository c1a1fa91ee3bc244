#include <lefort/mesh/find_zero_crossing.h>

#include <gtest/gtest.h>

namespace lefort::mesh::test_find_zero_crossing {
namespace {

const Vec3 kUp = Vec3::UnitZ();

bool below_one(const Vec3& p) { return p.z() < 1.0; }

TEST(FindZeroCrossing, SearchesOutwardsFromInside) {
  EXPECT_NEAR(find_zero_crossing({0, 0, 0.3}, kUp, below_one, 5.0, 1e-9).value(), 0.7, 1e-9);
}

TEST(FindZeroCrossing, SearchesInwardsFromOutside) {
  EXPECT_NEAR(find_zero_crossing({0, 0, 1.4}, kUp, below_one, 5.0, 1e-9).value(), -0.4, 1e-9);
}

TEST(FindZeroCrossing, FindsTheCloserOfTwo) {
  const InsidePredicate slab = [](const Vec3& p) { return p.z() < 1.0 || p.z() > 2.0; };
  EXPECT_NEAR(find_zero_crossing({0, 0, 0.0}, kUp, slab, 50.0, 1e-9).value(), 1.0, 1e-9);
}

TEST(FindZeroCrossing, ReturnsNothingBeyondReach) {
  EXPECT_FALSE(find_zero_crossing({0, 0, 0}, kUp, below_one, 0.9, 1e-9));
  EXPECT_TRUE(find_zero_crossing({0, 0, 0}, kUp, below_one, 1.0, 1e-9));
  EXPECT_FALSE(find_zero_crossing({0, 0, 0}, kUp, below_one, 1e-12, 1e-9));
}

}  // namespace
}  // namespace lefort::mesh::test_find_zero_crossing
