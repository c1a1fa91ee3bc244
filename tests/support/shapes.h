/// \file
/// Surfaces with known distances, areas and volumes, for tests of every layer. All closed shapes
/// are oriented counter-clockwise seen from outside; vertices are shared.
#pragma once

#include <lefort/core/types.h>
#include <lefort/geometry/triangle_mesh.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <utility>

namespace lefort::test {

/// Icosahedron with `subdivisions` 1-to-4 subdivisions; vertices are on the sphere. 20 *
/// 4^subdivisions triangles.
[[nodiscard]] inline geometry::TriangleMesh make_icosphere(double radius_mm, int subdivisions,
                                                           const Vec3& center = Vec3::Zero()) {
  const double t = std::numbers::phi;
  geometry::TriangleMesh mesh;
  mesh.vertices = {{-1, t, 0},  {1, t, 0},  {-1, -t, 0}, {1, -t, 0}, {0, -1, t},  {0, 1, t},
                   {0, -1, -t}, {0, 1, -t}, {t, 0, -1},  {t, 0, 1},  {-t, 0, -1}, {-t, 0, 1}};
  mesh.triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                    {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                    {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                    {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (Vec3& v : mesh.vertices) v.normalize();
  for (int level = 0; level < subdivisions; ++level) {
    std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middles;
    const auto middle = [&](std::int32_t a, std::int32_t b) {
      const auto [entry, fresh] =
          middles.try_emplace(std::minmax(a, b), std::int32_t(mesh.vertices.size()));
      if (fresh) {
        const Vec3 sum = mesh.vertices[std::size_t(a)] + mesh.vertices[std::size_t(b)];
        mesh.vertices.push_back(sum.normalized());
      }
      return entry->second;
    };
    std::vector<geometry::Triangle> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::int32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
  }
  for (Vec3& v : mesh.vertices) v = center + radius_mm * v;
  return mesh;
}

/// Axis-aligned box of 12 triangles.
[[nodiscard]] inline geometry::TriangleMesh make_box(const Vec3& low, const Vec3& high) {
  geometry::TriangleMesh mesh;
  for (int corner = 0; corner < 8; ++corner)
    mesh.vertices.emplace_back(corner & 1 ? high.x() : low.x(), corner & 2 ? high.y() : low.y(),
                               corner & 4 ? high.z() : low.z());
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

/// Torus about z: `major_mm` from the axis to the center of the tube of radius `minor_mm`.
[[nodiscard]] inline geometry::TriangleMesh make_torus(double major_mm, double minor_mm,
                                                       int around_axis, int around_tube) {
  geometry::TriangleMesh mesh;
  for (int i = 0; i < around_axis; ++i) {
    for (int j = 0; j < around_tube; ++j) {
      const double u = 2.0 * std::numbers::pi * i / around_axis;
      const double v = 2.0 * std::numbers::pi * j / around_tube;
      const double r = major_mm + minor_mm * std::cos(v);
      mesh.vertices.emplace_back(r * std::cos(u), r * std::sin(u), minor_mm * std::sin(v));
      const auto at = [&](int di, int dj) {
        return std::int32_t((i + di) % around_axis * around_tube + (j + dj) % around_tube);
      };
      mesh.triangles.push_back({at(0, 0), at(1, 0), at(1, 1)});
      mesh.triangles.push_back({at(0, 0), at(1, 1), at(0, 1)});
    }
  }
  return mesh;
}

/// Open sheet in the plane z = 0 with normal +z, centered on the origin, cells x cells squares.
[[nodiscard]] inline geometry::TriangleMesh make_sheet(double side_mm, int cells) {
  geometry::TriangleMesh mesh;
  for (int j = 0; j <= cells; ++j)
    for (int i = 0; i <= cells; ++i)
      mesh.vertices.emplace_back(side_mm * (double(i) / cells - 0.5),
                                 side_mm * (double(j) / cells - 0.5), 0.0);
  const auto at = [&](int i, int j) { return std::int32_t(j * (cells + 1) + i); };
  for (int j = 0; j < cells; ++j)
    for (int i = 0; i < cells; ++i) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return mesh;
}

/// Closed spike: a base polygon in z = 0 and an apex at (0, 0, height), where many triangles meet
/// at a sharp vertex.
[[nodiscard]] inline geometry::TriangleMesh make_spike(double base_radius_mm, double height_mm,
                                                       int sides) {
  geometry::TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {0, 0, height_mm}};
  for (int i = 0; i < sides; ++i) {
    const double u = 2.0 * std::numbers::pi * i / sides;
    mesh.vertices.emplace_back(base_radius_mm * std::cos(u), base_radius_mm * std::sin(u), 0.0);
    const auto here = std::int32_t(2 + i), next = std::int32_t(2 + (i + 1) % sides);
    mesh.triangles.push_back({here, next, 1});
    mesh.triangles.push_back({next, here, 0});
  }
  return mesh;
}

/// Splits edge `side` of a triangle at its middle and closes the slit with a triangle without area
/// (a cap), as in triangulations of measured data. A closed surface remains closed.
///
///      c                    c
///     / \                  /|\         The cap (a, b, m) is drawn open.
///    /   \       ->       / | \        .
///   a-----b              a--m--b
///                         \___/
[[nodiscard]] inline geometry::TriangleMesh with_cap(geometry::TriangleMesh mesh, Index triangle,
                                                     int side) {
  const geometry::Triangle old = mesh.triangles[std::size_t(triangle)];
  const std::int32_t a = old[std::size_t(side)], b = old[std::size_t((side + 1) % 3)];
  const std::int32_t c = old[std::size_t((side + 2) % 3)];
  const auto m = std::int32_t(mesh.vertices.size());
  mesh.vertices.push_back(0.5 *
                          (mesh.vertices[std::size_t(a)] + mesh.vertices[std::size_t(b)]).eval());
  mesh.triangles[std::size_t(triangle)] = {a, m, c};
  mesh.triangles.push_back({m, b, c});
  mesh.triangles.push_back({a, b, m});
  return mesh;
}

/// The surface as in STL files: every triangle has its own corners.
[[nodiscard]] inline geometry::TriangleMesh unwelded(const geometry::TriangleMesh& mesh) {
  geometry::TriangleMesh soup;
  for (Index t = 0; t < mesh.triangle_count(); ++t) {
    for (int k = 0; k < 3; ++k) soup.vertices.push_back(mesh.corner(t, k));
    const auto first = std::int32_t(3 * t);
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  return soup;
}

/// Both surfaces as one mesh, not stitched.
[[nodiscard]] inline geometry::TriangleMesh join(geometry::TriangleMesh first,
                                                 const geometry::TriangleMesh& second) {
  const auto offset = std::int32_t(first.vertices.size());
  first.vertices.insert(first.vertices.end(), second.vertices.begin(), second.vertices.end());
  for (const auto& [a, b, c] : second.triangles)
    first.triangles.push_back({a + offset, b + offset, c + offset});
  return first;
}

/// The same surface with every triangle flipped.
[[nodiscard]] inline geometry::TriangleMesh turn_inside_out(geometry::TriangleMesh mesh) {
  for (auto& [a, b, c] : mesh.triangles) std::swap(b, c);
  return mesh;
}

[[nodiscard]] inline geometry::TriangleMesh moved(geometry::TriangleMesh mesh,
                                                  const RigidTransform& motion) {
  for (Vec3& v : mesh.vertices) v = motion * v;
  return mesh;
}

}  // namespace lefort::test
