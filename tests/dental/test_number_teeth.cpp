#include <lefort/dental/assign_fdi.h>
#include <lefort/dental/number_teeth.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <set>
#include <vector>

namespace lefort::dental {
namespace {

using anatomy::Tooth;

constexpr std::array<double, 8> kUpperMean{8.5, 6.5, 7.5, 7.0, 7.0, 10.0, 9.0, 8.5};
constexpr std::array<double, 8> kLowerMean{5.0, 5.5, 7.0, 7.0, 7.0, 11.0, 10.5, 10.0};

int quadrant_of(bool is_upper, bool is_left) {
  return is_upper ? (is_left ? 2 : 1) : (is_left ? 3 : 4);
}

/// Parts of an arch from right to left, without the given numbers; widths vary by 5 %.
std::vector<std::pair<int, ArchPart>> arch_without(bool is_upper, const std::set<int>& missing,
                                                   double deviation_mm = 0.8) {
  const auto& widths = is_upper ? kUpperMean : kLowerMean;
  std::vector<std::pair<int, ArchPart>> parts;
  for (const bool is_left : {false, true}) {
    double edge = 0.0;
    for (int n = 1; n <= 8; ++n) {
      const double width = widths[std::size_t(n - 1)] * (1.0 + 0.05 * std::sin(3.0 * n + is_left));
      const int fdi = 10 * quadrant_of(is_upper, is_left) + n;
      const double center = (is_left ? 1.0 : -1.0) * (edge + 0.5 * width) + deviation_mm;
      if (!missing.contains(fdi)) parts.push_back({fdi, {center, width}});
      edge += width;
    }
  }
  std::sort(parts.begin(), parts.end(),
            [](const auto& a, const auto& b) { return a.second.center_mm < b.second.center_mm; });
  return parts;
}

TEST(AssignFdi, numbers_arches_with_gaps) {
  const std::vector<std::pair<bool, std::set<int>>> cases{
      {true, {}},
      {true, {18, 28}},
      {true, {18, 28, 16}},
      {true, {18, 17, 25, 28}},
      {true, {11, 21}},
      {false, {38, 48}},
      {false, {38, 48, 36, 46}},
      {false, {41, 31, 38}},
      {false, {48, 47, 46, 45}},
  };
  for (const auto& [is_upper, missing] : cases) {
    std::vector<ArchPart> parts;
    std::vector<int> expected;
    for (const auto& [fdi, part] : arch_without(is_upper, missing)) {
      expected.push_back(fdi);
      parts.push_back(part);
    }
    EXPECT_EQ(assign_fdi(parts, is_upper ? Tooth::kUpper : Tooth::kLower), expected);
  }
  EXPECT_TRUE(assign_fdi({}, Tooth::kUpper).empty());
}

TEST(AssignFdi, a_deviated_jaw_keeps_its_numbers) {
  for (const double deviation_mm : {-8.0, -5.0, 5.0, 8.0})
    for (const auto& missing : {std::set<int>{38, 48}, {38, 48, 36, 46}}) {
      std::vector<ArchPart> parts;
      std::vector<int> expected;
      for (const auto& [fdi, part] : arch_without(false, missing, deviation_mm)) {
        expected.push_back(fdi);
        parts.push_back(part);
      }
      EXPECT_EQ(assign_fdi(parts, Tooth::kLower), expected) << deviation_mm;
    }
}

TEST(AssignFdi, parts_that_are_no_tooth_get_no_number) {
  std::vector<ArchPart> parts;
  std::vector<int> expected;
  for (const auto& [fdi, part] : arch_without(true, {18, 28})) {
    if (fdi == 24) {  // A splinter between 23 and 24.
      parts.push_back({part.first_mm(), 1.0});
      expected.push_back(0);
    }
    parts.push_back(part);
    expected.push_back(fdi);
  }
  EXPECT_EQ(assign_fdi(parts, Tooth::kUpper), expected);
}

/// Crowns (ellipsoids that touch) and conical roots along a parabola.
struct MadeTooth {
  int fdi;
  Vec3 crown, apex;
  double half_width, half_depth;
  Vec3 along;  ///< Unit tangent of the arch.
};

/// Point of the arch y = 45 - x^2 / 18 at a length from the middle.
Vec3 arch_point(double along_mm, Vec3& tangent) {
  double length = 0.0, x = 0.0;
  constexpr double kStep = 0.01;
  while (length < std::abs(along_mm)) {
    length += kStep * std::hypot(1.0, x / 9.0);
    x += kStep;
  }
  const double side = along_mm < 0.0 ? -1.0 : 1.0;
  tangent = Vec3(1.0, -side * x / 9.0, 0.0).normalized();
  return {side * x, 45.0 - x * x / 18.0, 0.0};
}

/// A made frame: x left, y anterior, z superior.
std::vector<MadeTooth> make_teeth(bool is_upper, const std::set<int>& missing) {
  std::vector<MadeTooth> teeth;
  const double up = is_upper ? 1.0 : -1.0;
  for (const auto& [fdi, part] : arch_without(is_upper, missing)) {
    MadeTooth tooth;
    tooth.fdi = fdi;
    tooth.crown = arch_point(part.center_mm, tooth.along) + Vec3(0.0, 0.0, up * 4.0);
    tooth.apex = tooth.crown + Vec3(0.0, -1.0, up * 15.0);
    tooth.half_width = 0.5 * part.width_mm + 0.15;
    tooth.half_depth = fdi % 10 <= 3 ? 3.2 : 4.5;
    teeth.push_back(tooth);
  }
  return teeth;
}

bool is_in(const MadeTooth& tooth, const Vec3& p) {
  const Vec3 d = p - tooth.crown;
  const double a = tooth.along.dot(d) / tooth.half_width;
  const double b = tooth.along.cross(Vec3::UnitZ()).dot(d) / tooth.half_depth;
  const double c = d.z() / 4.0;
  if (a * a + b * b + c * c * c * c < 1.0) return true;
  const Vec3 axis = tooth.apex - tooth.crown;
  const double t = axis.dot(d) / axis.squaredNorm();
  if (t < 0.0 || t > 1.0) return false;
  const double radius = 0.75 * std::min(tooth.half_width, tooth.half_depth) * (1.0 - 0.6 * t);
  return (d - t * axis).norm() < radius;
}

/// The map of both jaws, in a head that is turned in the scan.
anatomy::ToothMap map_of(const std::vector<MadeTooth>& upper, const std::vector<MadeTooth>& lower,
                         const RigidTransform& X_LM) {
  anatomy::ToothMap map;
  map.grid.size = {150, 150, 110};
  map.grid.spacing_mm = {0.6, 0.6, 0.6};
  map.grid.origin_L = X_LM * Vec3(0.0, 15.0, 0.0) - Vec3(45.0, 45.0, 33.0);
  map.values.assign(std::size_t(map.grid.voxel_count()), Tooth::kNone);
  const RigidTransform X_ML = X_LM.inverse();
  for (Index v = 0; v < map.grid.voxel_count(); ++v) {
    const Vec3 p =
        X_ML * map.grid.point_L({double(v % 150), double(v / 150 % 150), double(v / (150 * 150))});
    for (const auto& [teeth, tooth] : {std::pair{&upper, Tooth::kUpper}, {&lower, Tooth::kLower}})
      if ((tooth == Tooth::kUpper) == (p.z() > 0.0))
        for (const MadeTooth& one : *teeth)
          if (is_in(one, p)) map.values[std::size_t(v)] = tooth;
  }
  return map;
}

TEST(NumberTeeth, separates_and_numbers_both_jaws) {
  const std::set<int> missing{18, 28, 38, 48, 16, 35};
  const auto upper = make_teeth(true, missing), lower = make_teeth(false, missing);
  RigidTransform X_LM = RigidTransform::Identity();
  // From x left, y anterior to LPS, and a turned head.
  X_LM.linear() = (Eigen::AngleAxisd(0.1, Vec3(0.4, 0.2, 1.0).normalized()) *
                   Eigen::AngleAxisd(std::acos(-1.0), Vec3::UnitZ()))
                      .toRotationMatrix();
  X_LM.translation() = Vec3(5.0, -40.0, 12.0);
  const DentalFrame frame{X_LM.linear().col(0), X_LM.linear().col(1), X_LM.linear().col(2),
                          X_LM * Vec3(0.0, 50.0, 60.0)};
  const NumberedTeeth found = number_teeth(map_of(upper, lower, X_LM), frame);
  EXPECT_EQ(found.missing, (std::vector<int>{16, 35}));
  ASSERT_EQ(found.teeth.size(), upper.size() + lower.size());
  for (const auto* const jaw : {&upper, &lower})
    for (const MadeTooth& made : *jaw) {
      const auto at = std::find_if(found.teeth.begin(), found.teeth.end(),
                                   [&](const NumberedTooth& one) { return one.fdi == made.fdi; });
      ASSERT_NE(at, found.teeth.end()) << made.fdi;
      EXPECT_LT((at->crown_L - X_LM * made.crown).norm(), 2.0) << made.fdi;
      EXPECT_LT((at->apex_L - X_LM * made.apex).norm(), 2.5) << made.fdi;
      EXPECT_GT(at->axis_L.dot(X_LM.linear() * (made.crown - made.apex).normalized()), 0.95)
          << made.fdi;
      EXPECT_NEAR(at->width_mm, 2.0 * made.half_width, 2.0) << made.fdi;
      const Vec3 v = found.numbers.grid.index_V(X_LM * made.crown);
      EXPECT_EQ(found.numbers.at(std::lround(v.x()), std::lround(v.y()), std::lround(v.z())),
                made.fdi);
    }
}

TEST(NumberTeeth, nothing_without_teeth) {
  anatomy::ToothMap empty;
  empty.grid.size = {5, 5, 5};
  empty.values.assign(125, Tooth::kNone);
  const NumberedTeeth found = number_teeth(empty, {});
  EXPECT_TRUE(found.teeth.empty());
  EXPECT_EQ(found.numbers.values.size(), 125U);
  EXPECT_EQ(found.missing.size(), 28U);
}

}  // namespace
}  // namespace lefort::dental
