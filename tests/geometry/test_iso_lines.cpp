#include <lefort/geometry/iso_lines.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

namespace lefort::geometry::test_iso_lines {
namespace {

template <class Function>
std::vector<double> tabulate(int columns, int rows, const Function& function) {
  std::vector<double> values;
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x) values.push_back(function(double(x), double(y)));
  return values;
}

TEST(IsoLines, OfTheDistanceToAPointIsACircle) {
  constexpr double kRadius = 30.3;
  const auto values =
      tabulate(81, 75, [](double x, double y) { return std::hypot(x - 40.2, y - 37.1); });
  const std::vector<Segment2> circle = iso_lines(values, 81, kRadius);
  EXPECT_NEAR(total_length(circle), 2.0 * std::numbers::pi * kRadius, 0.02);
  for (const Segment2& piece : circle)
    for (const Eigen::Vector2d& p : {piece.from, piece.to})
      EXPECT_NEAR((p - Eigen::Vector2d(40.2, 37.1)).norm(), kRadius, 0.01);
}

TEST(IsoLines, HaveHigherValuesToTheLeft) {
  const auto values =
      tabulate(40, 40, [](double x, double y) { return std::sin(0.3 * x) + std::cos(0.2 * y); });
  const auto gradient = [](const Eigen::Vector2d& p) {
    return Eigen::Vector2d(0.3 * std::cos(0.3 * p.x()), -0.2 * std::sin(0.2 * p.y()));
  };
  const std::vector<Segment2> lines = iso_lines(values, 40, 0.4);
  ASSERT_GT(lines.size(), 50U);
  for (const Segment2& piece : lines) {
    if (piece.length() < 1e-3) continue;
    const Eigen::Vector2d along = piece.to - piece.from, left(-along.y(), along.x());
    EXPECT_GT(left.dot(gradient(0.5 * (piece.from + piece.to))), 0.0);
  }
}

TEST(IsoLines, AreClosedUnlessTheyLeaveTheGrid) {
  // Many saddles, and values exactly at the level.
  const auto values = tabulate(30, 30, [](double x, double y) {
    const bool rim = x < 1 || y < 1 || x > 28 || y > 28;
    return rim ? -1.0 : double((int(x) * 7 + int(y) * 13 + int(x) * int(y)) % 5) - 2.0;
  });
  std::map<std::pair<double, double>, int> begun_less_ended;
  for (const Segment2& piece : iso_lines(values, 30, 0.0)) {
    ++begun_less_ended[{piece.from.x(), piece.from.y()}];
    --begun_less_ended[{piece.to.x(), piece.to.y()}];
  }
  EXPECT_GT(begun_less_ended.size(), 300U);
  for (const auto& [at, count] : begun_less_ended) EXPECT_EQ(count, 0);
}

TEST(IsoLines, AtASaddleTheMeanDecidesWhichCornersAreConnected) {
  // High at two opposite corners.
  const auto cut_corner = [](double high) {
    const std::vector<double> values = {high, -1.0, -1.0, high};
    const std::vector<Segment2> lines = iso_lines(values, 2, 0.0);
    EXPECT_EQ(lines.size(), 2U);
    // The corner that the first line cuts off.
    const Eigen::Vector2d middle = 0.5 * (lines[0].from + lines[0].to);
    return std::pair(std::lround(middle.x()), std::lround(middle.y()));
  };
  // High corners are connected: a low corner is cut off.
  EXPECT_EQ(cut_corner(2.0), (std::pair(1L, 0L)));
  EXPECT_EQ(cut_corner(0.5), (std::pair(0L, 0L)));
}

TEST(IsoLines, SkipSquaresWithValuesThatAreNotFinite) {
  auto values = tabulate(10, 3, [](double, double y) { return y; });
  EXPECT_DOUBLE_EQ(total_length(iso_lines(values, 10, 0.5)), 9.0);
  values[4] = std::numeric_limits<double>::infinity();
  EXPECT_DOUBLE_EQ(total_length(iso_lines(values, 10, 0.5)), 7.0);
  values[9] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_DOUBLE_EQ(total_length(iso_lines(values, 10, 0.5)), 6.0);
  EXPECT_TRUE(iso_lines(values, 30, 0.5).empty());  // A single row has no squares.
}

}  // namespace
}  // namespace lefort::geometry::test_iso_lines
