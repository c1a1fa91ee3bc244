/// \file
/// Surfaces with the defects of bad files: soups, repeated and duplicate triangles, needles, holes,
/// intersecting parts.
#pragma once

#include <lefort/geometry/triangle_mesh.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

#include "support/shapes.h"

namespace lefort::test {

/// 1 to 60 triangles in a cube of side 2 around the origin, with separate or shared corners.
[[nodiscard]] inline geometry::TriangleMesh make_soup(std::mt19937& random) {
  std::uniform_real_distribution<double> in(-1, 1);
  const auto point = [&] { return Vec3(in(random), in(random), in(random)); };
  geometry::TriangleMesh soup;
  for (auto v = 4 + random() % 12; v > 0; --v) soup.vertices.push_back(point());
  for (auto t = 1 + random() % 60; t > 0; --t) {
    geometry::Triangle triangle{};
    for (std::int32_t& corner : triangle) {
      corner = std::int32_t(random() % soup.vertices.size());
      if (random() % 3 != 0) continue;
      corner = std::int32_t(soup.vertices.size());
      soup.vertices.push_back(point());
    }
    soup.triangles.push_back(triangle);
  }
  return soup;
}

/// Adds defects: repeated triangles, opposite duplicates, triangles that are lines or points or
/// nearly so, vertices at equal or at non-finite positions.
inline void spoil(geometry::TriangleMesh& mesh, std::mt19937& random) {
  const auto any_triangle = [&] { return std::size_t(random() % mesh.triangles.size()); };
  const auto add_vertex = [&](const Vec3& p) {
    mesh.vertices.push_back(p);
    return std::int32_t(mesh.vertices.size()) - 1;
  };
  for (auto n = random() % 6; n > 0; --n) {
    const geometry::Triangle t = mesh.triangles[any_triangle()];
    const Vec3 a = mesh.vertices[std::size_t(t[0])], b = mesh.vertices[std::size_t(t[1])];
    constexpr double kOffsets[] = {1e-300, 1e-160, 1e-15, 1e-9, 1e-6, 1e-3};
    const double offset = kOffsets[random() % 6];
    switch (random() % 8) {
      case 0:  // Repeated, from another corner.
        mesh.triangles.push_back({t[1], t[2], t[0]});
        break;
      case 1:  // Opposite duplicate.
        mesh.triangles.push_back({t[2], t[1], t[0]});
        break;
      case 2:  // A point.
        mesh.triangles.push_back({t[0], t[0], t[1]});
        break;
      case 3:  // A line.
        mesh.triangles.push_back({t[0], t[1], add_vertex(0.5 * (a + b))});
        break;
      case 4:  // A needle.
        mesh.triangles.push_back({t[0], t[1], add_vertex(a + Vec3(offset, 0, 0))});
        break;
      case 5:  // With extremely small coordinates.
        mesh.triangles.push_back(
            {t[0], add_vertex(a + Vec3(offset, 0, 0)), add_vertex(a + Vec3(0, offset, 0))});
        break;
      case 6:  // A repeated position.
        mesh.triangles[any_triangle()][random() % 3] = add_vertex(a);
        break;
      default:  // Flipped.
        std::swap(mesh.triangles[any_triangle()][0], mesh.triangles[any_triangle()][1]);
    }
  }
}

/// One of many kinds of bad surface, of any size and anywhere.
[[nodiscard]] inline geometry::TriangleMesh make_ugly_mesh(std::mt19937& random) {
  std::uniform_real_distribution<double> in(-1, 1);
  geometry::TriangleMesh mesh;
  switch (random() % 6) {
    case 0:
    case 1:
      mesh = make_soup(random);
      break;
    case 2:  // Crumpled, with self-intersections.
      mesh = make_icosphere(1, 1);
      for (Vec3& v : mesh.vertices) v += 0.8 * Vec3(in(random), in(random), in(random));
      break;
    case 3:  // With holes.
      mesh = make_torus(0.7, 0.25, 9, 5);
      for (auto n = random() % 20; n > 0; --n) {
        std::swap(mesh.triangles[random() % mesh.triangles.size()], mesh.triangles.back());
        mesh.triangles.pop_back();
      }
      break;
    case 4:  // Parts that overlap, touch or have opposite orientation.
      mesh = join(make_box(Vec3(-1, -1, -1), Vec3(0, 0, 0)),
                  make_box(Vec3(-0.5 * double(random() % 3), 0, 0), Vec3(1, 1, in(random))));
      break;
    default:  // A plate without thickness.
      mesh = make_box(Vec3(-1, -1, 0), Vec3(1, 1, random() % 2 == 0 ? 0.0 : 1e-7));
  }
  spoil(mesh, random);
  const double size_mm = std::pow(10.0, 2 * in(random));
  const Vec3 at = 10 * size_mm * Vec3(in(random), in(random), in(random));
  const RigidTransform turn(Eigen::AngleAxisd(random() % 2 == 0 ? 0.0 : 3 * in(random),
                                              Vec3(in(random), in(random), 1).normalized()));
  for (Vec3& v : mesh.vertices) v = at + size_mm * (turn * v);
  return mesh;
}

/// A closed surface, star-shaped about the origin, with random radii in a range.
[[nodiscard]] inline geometry::TriangleMesh make_crumpled_ball(unsigned seed, double min_mm,
                                                               double max_mm) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> radius(min_mm, max_mm);
  geometry::TriangleMesh ball = make_icosphere(1.0, 2);
  for (Vec3& v : ball.vertices) v *= radius(random);
  return ball;
}

/// A box with a triangle without area at every edge.
[[nodiscard]] inline geometry::TriangleMesh make_capped_box(const Vec3& low, const Vec3& high) {
  geometry::TriangleMesh capped = make_box(low, high);
  for (Index t = 0; t < 12; ++t)
    for (int side = 0; side < 3; ++side) capped = with_cap(capped, t, side);
  return capped;
}

/// A Moebius band of `squares` squares: it has no outside.
[[nodiscard]] inline geometry::TriangleMesh make_moebius_strip(double radius_mm, double width_mm,
                                                               int squares) {
  geometry::TriangleMesh strip;
  for (int i = 0; i < squares; ++i) {
    const double u = 2.0 * std::numbers::pi * i / squares;
    for (const double across : {-0.5, 0.5}) {
      const double r = radius_mm + across * width_mm * std::cos(0.5 * u);
      strip.vertices.emplace_back(r * std::cos(u), r * std::sin(u),
                                  across * width_mm * std::sin(0.5 * u));
    }
    const auto at = [&](int step, int end) {
      const int here = i + step;
      return std::int32_t(here < squares ? 2 * here + end : 1 - end);
    };
    strip.triangles.push_back({at(0, 0), at(1, 0), at(1, 1)});
    strip.triangles.push_back({at(0, 0), at(1, 1), at(0, 1)});
  }
  return strip;
}

}  // namespace lefort::test
