/// \file
/// Surfaces with known pictures.
#pragma once

#include <lefort/geometry/triangle_mesh.h>

#include <cmath>
#include <numbers>

namespace lefort::report::test {

/// A sphere of `rings` by 2 `rings` facets with its poles on z, corners on the sphere.
inline geometry::TriangleMesh sphere(const Vec3& center_L, double radius_mm, int rings) {
  const int around = 2 * rings;
  geometry::TriangleMesh mesh;
  for (int i = 0; i <= rings; ++i) {
    const double polar = std::numbers::pi * double(i) / rings;
    for (int j = 0; j < around; ++j) {
      const double azimuth = 2.0 * std::numbers::pi * double(j) / around;
      mesh.vertices.push_back(center_L + radius_mm * Vec3(std::sin(polar) * std::cos(azimuth),
                                                          std::sin(polar) * std::sin(azimuth),
                                                          std::cos(polar)));
    }
  }
  for (int i = 0; i < rings; ++i) {
    for (int j = 0; j < around; ++j) {
      const int a = i * around + j;
      const int b = i * around + (j + 1) % around;
      mesh.triangles.push_back({a, a + around, b});
      mesh.triangles.push_back({b, a + around, b + around});
    }
  }
  return mesh;
}

/// A square of two triangles that faces anterior (-y), with x and z from -half to half.
inline geometry::TriangleMesh square_facing_front(double half_mm, double y_L) {
  return {{{-half_mm, y_L, -half_mm},
           {half_mm, y_L, -half_mm},
           {half_mm, y_L, half_mm},
           {-half_mm, y_L, half_mm}},
          {{0, 1, 2}, {0, 2, 3}}};
}

}  // namespace lefort::report::test
