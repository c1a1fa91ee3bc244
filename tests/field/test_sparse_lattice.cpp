#include <lefort/core/check.h>
#include <lefort/field/storage/sparse_lattice.h>

#include <gtest/gtest.h>

namespace lefort::field::test_sparse_lattice {
namespace {

TEST(SparseLattice, EveryPointHasOneOffset) {
  std::vector<std::int32_t> all(5 * 5 * 5);
  for (std::size_t b = 0; b < all.size(); ++b) all[b] = std::int32_t(b);
  SparseLattice lattice(16, all, 0.0F);
  for (int k = -8; k < 32; ++k)
    for (int j = -8; j < 32; ++j)
      for (int i = -8; i < 32; ++i) {
        const std::int32_t slot = lattice.slot_of(lattice.brick_of({i, j, k}));
        lattice.brick(slot)[std::size_t(SparseLattice::linear_offset({i, j, k}))] += 1.0F;
      }
  for (const float visits : lattice.values()) ASSERT_EQ(visits, 1.0F);
}

TEST(SparseLattice, FirstPointOfABrickHasOffsetZero) {
  const SparseLattice lattice(16, {}, 0.0F);
  for (std::int32_t brick = 0; brick < 125; ++brick) {
    EXPECT_EQ(lattice.brick_of(lattice.first_point(brick)), brick);
    EXPECT_EQ(SparseLattice::linear_offset(lattice.first_point(brick)), 0);
  }
}

TEST(SparseLattice, AbsentBricksGiveTheAbsentValue) {
  SparseLattice lattice(16, {31}, 2.0F);  // Brick (1, 1, 1) begins at point (0, 0, 0).
  EXPECT_EQ(lattice.at({0, 0, 0}, -1.0F), 2.0F);
  EXPECT_EQ(lattice.at({7, 7, 7}, -1.0F), 2.0F);
  EXPECT_EQ(lattice.at({8, 0, 0}, -1.0F), -1.0F);
  EXPECT_EQ(lattice.at({-1, 0, 0}, -1.0F), -1.0F);
}

TEST(SparseLattice, BricksMustAscend) {
  EXPECT_THROW(SparseLattice(16, {3, 3}, 0.0F), LogicError);
  EXPECT_THROW(SparseLattice(16, {125}, 0.0F), LogicError);
  EXPECT_THROW(SparseLattice(12, {}, 0.0F), LogicError);
}

}  // namespace
}  // namespace lefort::field::test_sparse_lattice
