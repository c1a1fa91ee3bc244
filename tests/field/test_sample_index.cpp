#include <lefort/field/storage/sample_index.h>

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace lefort::field::test_sample_index {
namespace {

TEST(SampleIndex, NumbersMarkedPointsInTheirOrderInTheList) {
  SampleIndex index(32);
  std::mt19937 random(1);
  std::set<LatticePoint> marked;
  for (int n = 0; n < 3000; ++n) {
    const LatticePoint p = {int(random() % 33), int(random() % 33), int(random() % 33)};
    index.mark(p);
    marked.insert(p);
  }
  index.mark({32, 32, 32});
  marked.insert({32, 32, 32});
  index.finish();
  ASSERT_EQ(index.count(), Index(marked.size()));

  const std::vector<LatticePoint> points = index.points();
  EXPECT_EQ(std::set<LatticePoint>(points.begin(), points.end()), marked);
  for (std::size_t n = 0; n < points.size(); ++n) EXPECT_EQ(index.number_of(points[n]), n);
}

}  // namespace
}  // namespace lefort::field::test_sample_index
