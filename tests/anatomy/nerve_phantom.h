/// \file
/// Scans of synthetic heads with the canals of the inferior alveolar nerves.
#pragma once

#include <lefort/anatomy/minimal_path.h>
#include <lefort/anatomy/parametric_head.h>
#include <lefort/anatomy/trace_nerve.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace lefort::test {

using namespace anatomy;

inline constexpr double kCanalRadius_mm = 1.3;

inline double distance_to_line(const std::vector<Vec3>& line, const Vec3& p) {
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t n = 1; n < line.size(); ++n) {
    const Vec3 edge = line[n] - line[n - 1];
    const double t = std::clamp(edge.dot(p - line[n - 1]) / edge.squaredNorm(), 0.0, 1.0);
    smallest = std::min(smallest, (line[n - 1] + t * edge - p).norm());
  }
  return smallest;
}

/// The canal of one side, from the medial surface of the ramus to the lateral surface of the body,
/// in the mean head; in frame L.
inline std::vector<Vec3> canal_of(const ParametricHead& head, double side) {
  std::vector<Vec3> line;
  for (const Vec3& mean :
       {Vec3(41.0, -30.0, -38.0), Vec3(44.5, -29.5, -43.0), Vec3(44.0, -31.0, -55.0),
        Vec3(41.0, -36.0, -64.0), Vec3(36.0, -46.0, -71.0), Vec3(30.0, -56.0, -75.0),
        Vec3(25.0, -65.0, -76.5), Vec3(23.0, -69.0, -74.5), Vec3(28.0, -71.0, -72.5)})
    line.push_back(head.X_LH() * head.from_mean(Vec3(side * mean.x(), mean.y(), mean.z())));
  return line;
}

/// Cancellous bone below 2 mm of cortex; the canal has a wall of 0.5 mm.
inline LabeledScan scan_with_canals(const ParametricHead& head, double voxel_mm) {
  LabeledScan scan = scan_of(head, voxel_mm, 20.0, 5);
  const std::vector<Vec3> right = canal_of(head, -1.0), left = canal_of(head, 1.0);
  const image::Grid& grid = scan.ct.grid;
  for (Index k = 0; k < grid.size[2]; ++k)
    for (Index j = 0; j < grid.size[1]; ++j)
      for (Index i = 0; i < grid.size[0]; ++i) {
        const Vec3 p_L = grid.point_L({double(i), double(j), double(k)});
        const double depth = head.mandible(p_L);
        if (depth < -1.0) continue;
        auto& hu = scan.ct.at(i, j, k);
        const double noise = double((i * 7919 + j * 104729 + k * 1299709) % 81) - 40.0;
        if (depth > 2.0) hu = std::int16_t(320.0 + noise);
        const double r = std::min(distance_to_line(right, p_L), distance_to_line(left, p_L));
        if (r < kCanalRadius_mm + 0.5 && depth > 0.0) hu = std::int16_t(650.0 + noise);
        if (r < kCanalRadius_mm) hu = std::int16_t(90.0 + noise);
      }
  return scan;
}

inline Vec3 landmark(const ParametricHead& head, const std::string& name) {
  for (const NamedPoint& one : true_landmarks(head))
    if (one.name == name) return one.point_L;
  ADD_FAILURE() << name;
  return Vec3::Zero();
}

inline MandibleSide side_of_head(const ParametricHead& head, double side) {
  const char* const letter = side > 0.0 ? "-L" : "-R";
  const Mat3 R = head.X_LH().linear();
  return {side * R.col(0),
          -R.col(1),
          R.col(2),
          landmark(head, "Pg"),
          landmark(head, std::string("Go") + letter),
          landmark(head, std::string("Co") + letter)};
}

}  // namespace lefort::test
