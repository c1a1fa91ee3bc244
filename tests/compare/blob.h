/// \file
/// Bodies without symmetry, with an analytical surface that can be triangulated in different ways.
#pragma once

#include <lefort/geometry/triangle_mesh.h>

#include <cmath>

#include "support/shapes.h"

namespace lefort::test {

/// A perturbed ellipsoid. `twist` rotates the triangulation, not the body.
[[nodiscard]] inline geometry::TriangleMesh make_blob(const Vec3& center, const Vec3& radii_mm,
                                                      int subdivisions,
                                                      const Mat3& twist = Mat3::Identity()) {
  geometry::TriangleMesh mesh = make_icosphere(1.0, subdivisions);
  for (Vec3& v : mesh.vertices) {
    const Vec3 d = twist * v;
    const double height = 1.0 + 0.08 * std::sin(4.0 * d.x() + 1.0) +
                          0.06 * std::cos(5.0 * d.y() + 3.0 * d.z()) + 0.1 * d.x() * d.z();
    v = center + height * radii_mm.cwiseProduct(d);
  }
  return mesh;
}

[[nodiscard]] inline geometry::TriangleMesh joined(geometry::TriangleMesh one,
                                                   const geometry::TriangleMesh& other) {
  const auto first = std::int32_t(one.vertices.size());
  one.vertices.insert(one.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& [a, b, c] : other.triangles)
    one.triangles.push_back({a + first, b + first, c + first});
  return one;
}

/// A rotation that gives another triangulation than the identity.
[[nodiscard]] inline Mat3 some_twist() {
  return Eigen::AngleAxisd(0.7, Vec3(1.0, 2.0, -0.5).normalized()).toRotationMatrix();
}

}  // namespace lefort::test
