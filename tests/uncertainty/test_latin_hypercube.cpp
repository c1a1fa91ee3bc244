#include <lefort/uncertainty/latin_hypercube.h>

#include <gtest/gtest.h>

#include <set>

namespace lefort::uncertainty {

TEST(NestedLatinHypercube, EveryDoublingHasOnePointPerStratum) {
  const Eigen::MatrixXd points = nested_latin_hypercube(4, 200, 7);
  for (const Index count : {25, 50, 100, 200})
    for (Index j = 0; j < points.cols(); ++j) {
      std::set<Index> strata;
      for (Index i = 0; i < count; ++i) strata.insert(Index(points(i, j) * double(count)));
      EXPECT_EQ(Index(strata.size()), count);
      EXPECT_EQ(*strata.begin(), 0);
      EXPECT_EQ(*strata.rbegin(), count - 1);
    }
}

TEST(NestedLatinHypercube, MorePointsBeginWithFewer) {
  const Eigen::MatrixXd many = nested_latin_hypercube(3, 160, 5),
                        few = nested_latin_hypercube(3, 30, 5);
  EXPECT_EQ((many.topRows(30) - few).norm(), 0.0);
}

TEST(NestedLatinHypercube, SeedsDecide) {
  EXPECT_EQ((nested_latin_hypercube(3, 50, 5) - nested_latin_hypercube(3, 50, 5)).norm(), 0.0);
  EXPECT_GT((nested_latin_hypercube(3, 50, 5) - nested_latin_hypercube(3, 50, 6)).norm(), 1.0);
}

TEST(NestedLatinHypercube, InputsAreNotCorrelated) {
  const Eigen::MatrixXd points = nested_latin_hypercube(2, 400, 3);
  const Eigen::MatrixXd centered = points.rowwise() - points.colwise().mean();
  const double correlation =
      centered.col(0).dot(centered.col(1)) / (centered.col(0).norm() * centered.col(1).norm());
  EXPECT_LT(std::abs(correlation), 0.15);  // Three standard deviations of 400 independent points.
}

/// Bits of a generator that is not that of a library: a change would make stored samples useless.
TEST(NestedLatinHypercube, FirstPointOfSeedOne) {
  const Eigen::MatrixXd points = nested_latin_hypercube(2, 1, 1);
  EXPECT_EQ(points(0, 0), nested_latin_hypercube(2, 400, 1)(0, 0));
  EXPECT_GT(points(0, 0), 0.0);
  EXPECT_LT(points(0, 0), 1.0);
}

}  // namespace lefort::uncertainty
