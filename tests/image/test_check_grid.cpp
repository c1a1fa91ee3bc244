#include <lefort/image/check_grid.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace lefort::image::test_check_grid {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Grid oblique_grid() {
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1.0, 2.0, -0.5).normalized()).toRotationMatrix();
  return {.size = {3, 5, 7},
          .spacing_mm = {0.4, 0.5, 1.25},
          .origin_L = {-80, 3, 9},
          .direction = turn};
}

std::string complaint(const Grid& grid) {
  const auto result = check_grid(grid);
  if (result) return "";
  EXPECT_EQ(result.error().code, ErrorCode::kFileCorrupt);
  return result.error().message;
}

TEST(CheckGrid, AcceptsAnObliqueGridAndOneRoundedByAFile) {
  Grid grid = oblique_grid();
  EXPECT_EQ(complaint(grid), "");
  grid.direction = (grid.direction * 1e5).array().round().matrix() * 1e-5;
  EXPECT_EQ(complaint(grid), "");
}

TEST(CheckGrid, RejectsSizesThatAreEmptyNegativeOrOverflow) {
  for (const Index n : {Index{0}, Index{-4}, Index{1} << 40, std::numeric_limits<Index>::max()}) {
    Grid grid = oblique_grid();
    grid.size[1] = n;
    EXPECT_NE(complaint(grid).find("voxels"), std::string::npos) << n;
  }
  Grid grid = oblique_grid();
  grid.size = {Index{1} << 22, Index{1} << 21, Index{1} << 21};  // The product is 2^64.
  EXPECT_NE(complaint(grid).find("voxels"), std::string::npos);
  grid.size = {2048, 1024, 1024};
  EXPECT_EQ(complaint(grid), "");
  grid.size = {2049, 1024, 1024};
  EXPECT_NE(complaint(grid), "");
}

TEST(CheckGrid, RejectsSpacingsThatAreNotPositiveLengths) {
  for (const double spacing_mm : {0.0, -1.0, kNan, kInfinity, 1e-9, 1e9}) {
    Grid grid = oblique_grid();
    grid.spacing_mm.z() = spacing_mm;
    EXPECT_NE(complaint(grid).find("spacing"), std::string::npos) << spacing_mm;
  }
}

TEST(CheckGrid, RejectsAnOriginThatIsNotFiniteOrTooFar) {
  for (const double x_mm : {kNan, -kInfinity, 1e30}) {
    Grid grid = oblique_grid();
    grid.origin_L.y() = x_mm;
    EXPECT_NE(complaint(grid).find("origin"), std::string::npos) << x_mm;
  }
}

TEST(CheckGrid, RejectsAxesThatAreShearedScaledMirroredOrNotFinite) {
  Grid sheared = oblique_grid();
  sheared.direction.col(2) =
      (sheared.direction.col(2) + 0.2 * sheared.direction.col(1)).normalized();
  EXPECT_NE(complaint(sheared).find("orthogonal"), std::string::npos);
  Grid scaled = oblique_grid();
  scaled.direction *= 1.01;
  EXPECT_NE(complaint(scaled).find("orthogonal"), std::string::npos);
  Grid broken = oblique_grid();
  broken.direction(1, 1) = kNan;
  EXPECT_NE(complaint(broken).find("orthogonal"), std::string::npos);
  Grid mirrored = oblique_grid();
  mirrored.direction.col(0) *= -1.0;
  EXPECT_NE(complaint(mirrored).find("left-handed"), std::string::npos);
}

}  // namespace
}  // namespace lefort::image::test_check_grid
