/// \file
/// Exact distances by brute force, in double precision: the reference for fields.
#pragma once

#include <lefort/core/types.h>
#include <lefort/field/distance_field.h>
#include <lefort/field/query/trilinear.h>
#include <lefort/geometry/bvh.h>
#include <lefort/geometry/closest_point.h>
#include <lefort/geometry/triangle_mesh.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace lefort::test {

/// Unsigned distance [mm].
[[nodiscard]] inline double brute_distance(const geometry::TriangleMesh& mesh, const Vec3& p) {
  double minimum = std::numeric_limits<double>::infinity();
  for (Index t = 0; t < mesh.triangle_count(); ++t)
    minimum = std::min(minimum, geometry::closest_point_on_triangle(
                                    p, mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2))
                                    .squared_distance_mm2);
  return std::sqrt(minimum);
}

/// Position of a lattice point.
[[nodiscard]] inline Vec3 position_of(const field::FieldFrame& frame, int i, int j, int k) {
  return frame.origin_B + frame.cell_mm * Vec3(i, j, k);
}

/// The cell that a query at `p_B` uses. \pre p_B lies in the box.
[[nodiscard]] inline field::CellSamples cell_around(const field::DistanceField& field,
                                                    const Vec3& p_B) {
  const Vec3 u = (p_B - field.frame().origin_B) * (1.0 / field.cell_mm());
  field::LatticePoint low{};
  for (int k = 0; k < 3; ++k)
    low[std::size_t(k)] = std::min(int(u[k]), field.frame().resolution - 1);
  return field.cell(low);
}

/// Error of the search in single precision, on surfaces up to 60 mm wide.
inline constexpr double kFloatError_mm = 2e-5;

/// Max error [mm] at the samples of all finest cells whose samples are in the band; each such cell
/// must be in the band of the field.
[[nodiscard]] inline double max_error_at_samples(const field::DistanceField& field,
                                                 const geometry::TriangleMesh& mesh) {
  const field::FieldFrame& frame = field.frame();
  const geometry::Bvh bvh(mesh);
  const int n = frame.resolution + 1;
  std::vector<double> exact;
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        exact.push_back(bvh.signed_distance(position_of(frame, i, j, k)).distance_mm);
  const auto exact_at = [&](const field::LatticePoint& p) {
    return exact[std::size_t((p[2] * n + p[1]) * n + p[0])];
  };
  double largest = 0.0;
  for (int c = 0; c < (n - 1) * (n - 1) * (n - 1); ++c) {
    const field::LatticePoint low = {c % (n - 1), c / (n - 1) % (n - 1), c / (n - 1) / (n - 1)};
    std::array<field::LatticePoint, 8> corners{};
    bool in_band = true;
    for (int corner = 0; corner < 8; ++corner) {
      corners[std::size_t(corner)] = {low[0] + (corner & 1), low[1] + (corner >> 1 & 1),
                                      low[2] + (corner >> 2)};
      in_band = in_band &&
                std::abs(exact_at(corners[std::size_t(corner)])) < frame.band_mm - kFloatError_mm;
    }
    if (!in_band) continue;
    const field::CellSamples cell = field.cell(low);
    EXPECT_EQ(field::zone_of(cell.corners), field::Zone::kBand)
        << low[0] << ' ' << low[1] << ' ' << low[2];
    std::array<double, 8> values{};
    for (std::size_t i = 0; i < 8; ++i) values[i] = double(cell.corners[i]);
    for (const field::LatticePoint& p : corners) {
      const std::array<double, 3> t = {double(p[0] - cell.low[0]) / cell.cells,
                                       double(p[1] - cell.low[1]) / cell.cells,
                                       double(p[2] - cell.low[2]) / cell.cells};
      largest = std::max(largest, std::abs(field::trilinear(values, t) - exact_at(p)));
    }
  }
  return largest;
}

}  // namespace lefort::test
