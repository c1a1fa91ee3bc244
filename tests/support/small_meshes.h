/// \file
/// Surfaces of one to eight triangles on a small grid: every way in which triangles can meet, and
/// small solids whose interior is known independently of the triangles.
#pragma once

#include <lefort/geometry/triangle_mesh.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "support/shapes.h"

namespace lefort::test {

struct SmallMesh {
  std::string name;
  geometry::TriangleMesh mesh;
  /// Whether a point is inside; empty unless the repaired surface bounds a solid.
  std::function<bool(const Vec3&)> is_inside{};
};

/// Corners of a cube of side 1, by their bits x, y, z; the unit of the shapes below.
using Soup = std::vector<std::array<int, 3>>;

/// A triangle soup, with separate or shared corners.
[[nodiscard]] inline geometry::TriangleMesh mesh_of(const Soup& soup, bool welded) {
  geometry::TriangleMesh mesh;
  const auto place = [](int corner) { return Vec3(corner & 1, corner >> 1 & 1, corner >> 2 & 1); };
  if (welded)
    for (int corner = 0; corner < 8; ++corner) mesh.vertices.push_back(place(corner));
  for (const auto& triangle : soup) {
    geometry::Triangle t{};
    for (std::size_t k = 0; k < 3; ++k) {
      t[k] = std::int32_t(welded ? triangle[k] : std::ssize(mesh.vertices));
      if (!welded) mesh.vertices.push_back(place(triangle[k]));
    }
    mesh.triangles.push_back(t);
  }
  return mesh;
}

/// Equal for soups that differ by a symmetry of the cube, the order of triangles, or the first
/// corner of a triangle.
[[nodiscard]] inline Soup canonical(const Soup& soup) {
  Soup minimum;
  std::array<int, 3> axes = {0, 1, 2};
  do {
    for (int flips = 0; flips < 8; ++flips) {
      Soup moved = soup;
      for (auto& triangle : moved) {
        for (int& corner : triangle) {
          int bits = 0;
          for (int k = 0; k < 3; ++k) bits |= (corner >> axes[std::size_t(k)] & 1) << k;
          corner = bits ^ flips;
        }
        std::rotate(triangle.begin(), std::min_element(triangle.begin(), triangle.end()),
                    triangle.end());
      }
      std::sort(moved.begin(), moved.end());
      if (minimum.empty() || moved < minimum) minimum = std::move(moved);
    }
  } while (std::next_permutation(axes.begin(), axes.end()));
  return minimum;
}

/// Every soup of one and of two triangles up to symmetry, including points and lines.
[[nodiscard]] inline std::vector<Soup> soups_of_two() {
  Soup triangles;
  for (int a = 0; a < 8; ++a)
    for (int b = 0; b < 8; ++b)
      for (int c = 0; c < 8; ++c)
        if (a <= b && a <= c && !(a == c && b != a)) triangles.push_back({a, b, c});
  std::set<Soup> ones, found;
  for (const auto& one : triangles) ones.insert(canonical({one}));
  for (const Soup& one : ones) {
    found.insert(one);
    for (const auto& other : triangles) found.insert(canonical({one[0], other}));
  }
  return {found.begin(), found.end()};
}

/// Each soup of two triangles with more triangles, three to six in total.
[[nodiscard]] inline std::vector<Soup> soups_of_six() {
  std::set<Soup> found;
  std::mt19937 random(1);
  for (const Soup& two : soups_of_two())
    for (std::size_t size = 3; size <= 6; ++size) {
      Soup soup = two;
      while (soup.size() < size) {
        if (random() % 4 == 0) {  // An existing triangle, repeated or flipped.
          std::array<int, 3> again = soup[random() % soup.size()];
          if (random() % 2 == 0) std::swap(again[0], again[1]);
          soup.push_back(again);
        } else {
          soup.push_back({int(random() % 8), int(random() % 8), int(random() % 8)});
        }
      }
      found.insert(canonical(soup));
    }
  return {found.begin(), found.end()};
}

using Tetrahedron = std::array<Vec3, 4>;

[[nodiscard]] inline double volume6(const Tetrahedron& t) {
  return (t[1] - t[0]).cross(t[2] - t[0]).dot(t[3] - t[0]);
}

[[nodiscard]] inline bool contains(const Tetrahedron& t, const Vec3& p) {
  for (std::size_t k = 0; k < 4; ++k) {
    Tetrahedron with_p = t;
    with_p[k] = p;
    if (volume6(with_p) * volume6(t) < 0.0) return false;
  }
  return true;
}

/// \pre volume6(t) > 0.
[[nodiscard]] inline geometry::TriangleMesh surface_of(const Tetrahedron& t) {
  return {{t.begin(), t.end()}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};
}

/// A tetrahedron with corners on a grid of 3 x 3 x 3, positive.
[[nodiscard]] inline Tetrahedron random_tetrahedron(std::mt19937& random) {
  for (;;) {
    Tetrahedron t;
    for (Vec3& p : t) p = Vec3(double(random() % 3), double(random() % 3), double(random() % 3));
    if (volume6(t) < 0.0) std::swap(t[0], t[1]);
    if (volume6(t) > 0.0) return t;
  }
}

/// Flips some triangles, repeats some, and adds some that are points or lines, all of which is
/// repaired.
inline void scramble(geometry::TriangleMesh& mesh, std::mt19937& random) {
  for (geometry::Triangle& t : mesh.triangles) {
    if (random() % 3 == 0) std::swap(t[0], t[1]);
    std::rotate(t.begin(), t.begin() + random() % 3, t.end());
  }
  for (auto n = random() % 3; n > 0; --n) {
    const geometry::Triangle t = mesh.triangles[random() % mesh.triangles.size()];
    mesh.triangles.push_back(random() % 2 == 0 ? geometry::Triangle{t[1], t[2], t[0]}
                                               : geometry::Triangle{t[0], t[1], t[1]});
  }
}

/// Solids of one or two tetrahedra, with caps, cavities and touching parts.
[[nodiscard]] inline std::vector<SmallMesh> small_solids(int count) {
  std::vector<SmallMesh> solids;
  std::mt19937 random(2);
  for (int n = 0; n < count; ++n) {
    const Tetrahedron t = random_tetrahedron(random);
    SmallMesh solid{"tetrahedron", surface_of(t), [t](const Vec3& p) { return contains(t, p); }};
    switch (n % 5) {
      case 0:
        break;
      case 1: {  // Another corner on the far side of a face; the solid may be non-convex.
        const Vec3 middle = (t[0] + t[1] + t[2]) / 3.0;
        const Tetrahedron other = {t[0], t[2], t[1],
                                   middle - double(1 + random() % 2) * 0.25 * (t[3] - middle)};
        solid.name = "two tetrahedra with a common face";
        solid.mesh.vertices.push_back(other[3]);
        solid.mesh.triangles = {{0, 1, 3}, {1, 2, 3}, {0, 3, 2}, {1, 0, 4}, {2, 1, 4}, {0, 2, 4}};
        solid.is_inside = [t, other](const Vec3& p) {
          return contains(t, p) || contains(other, p);
        };
        break;
      }
      case 2: {  // A slit closed by a triangle without area.
        solid.name = "tetrahedron with a cap";
        solid.mesh = with_cap(solid.mesh, Index(random() % 4), int(random() % 3));
        break;
      }
      case 3: {  // A cavity of a quarter of its size in its center.
        const Vec3 middle = 0.25 * (t[0] + t[1] + t[2] + t[3]);
        Tetrahedron hole = t;
        for (Vec3& p : hole) p = middle + 0.25 * (p - middle);
        solid.name = "tetrahedron with a cavity";
        solid.mesh = join(solid.mesh, turn_inside_out(surface_of(hole)));
        solid.is_inside = [t, hole](const Vec3& p) { return contains(t, p) && !contains(hole, p); };
        break;
      }
      default: {  // Mirrored at a corner, where both meet.
        Tetrahedron other = t;
        for (Vec3& p : other) p = 2.0 * t[0] - p;
        std::swap(other[1], other[2]);
        solid.name = "two tetrahedra with a common corner";
        solid.mesh = join(solid.mesh, surface_of(other));
        solid.is_inside = [t, other](const Vec3& p) {
          return contains(t, p) || contains(other, p);
        };
      }
    }
    if (n % 5 != 3) scramble(solid.mesh, random);
    solids.push_back(std::move(solid));
  }
  return solids;
}

}  // namespace lefort::test
