/// \file
/// A dental arch as a height over a parabola, with teeth of different sizes.
#pragma once

#include <lefort/core/types.h>
#include <lefort/geometry/triangle_mesh.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace lefort::test {

struct ArchShape {
  double half_width_mm = 27.0, length_mm = 42.0;
  double seed = 1.0;      ///< Of sizes and cusps.
  double step_mm = 0.45;  ///< Of the triangulation.
  double skirt_mm = 0.0;  ///< Width of gingiva beside the crowns.
};

/// Number between 0 and 1.
inline double some_number(double seed, int n) {
  const double x = std::sin(12.9898 * seed + 78.233 * n) * 43758.5453;
  return x - std::floor(x);
}

/// The open surface of a lower arch: z to superior, -y to anterior. With `is_upper` the middle of the
/// same surface faces to inferior, so that both touch there.
inline geometry::TriangleMesh make_arch(const ArchShape& shape, bool is_upper = false) {
  constexpr double kHalfCrown_mm = 4.5, kTooth_mm = 7.0;
  const double half = is_upper ? kHalfCrown_mm - 1.5 : kHalfCrown_mm + shape.skirt_mm;
  const int across = int(std::ceil(2.0 * half / shape.step_mm));
  const int along = int(std::ceil(130.0 / shape.step_mm));
  geometry::TriangleMesh mesh;
  double s = 0.0;
  for (int i = 0; i <= along; ++i) {
    const double t = -1.0 + 2.0 * i / along;
    const Vec3 tangent = Vec3(shape.half_width_mm, 2.0 * shape.length_mm * t, 0.0);
    s += i == 0 ? 0.0 : tangent.norm() * 2.0 / along;
    const Vec3 normal = Vec3(-tangent.y(), tangent.x(), 0.0).normalized();
    const int tooth = int(s / kTooth_mm);
    const double in_tooth = s / kTooth_mm - tooth;
    const double r = some_number(shape.seed, tooth), q = some_number(shape.seed + 5.0, tooth);
    const double border_mm = kTooth_mm * std::min(in_tooth, 1.0 - in_tooth);
    for (int j = 0; j <= across; ++j) {
      const double v = -half + 2.0 * half * j / across;
      const double side = std::min(std::abs(v) / kHalfCrown_mm, 1.0);
      const double cusps = (0.5 + 0.7 * r) * std::cos(std::numbers::pi * v / (1.8 + 0.8 * q)) *
                           std::sin(std::numbers::pi * in_tooth * (1.0 + std::floor(3.0 * q)));
      const double crown =
          4.0 + (2.0 + 0.8 * (r - 0.5) + cusps) * (1.0 - std::exp(-border_mm * border_mm));
      const double z = crown * (1.0 - std::pow(side, 6.0));
      const Vec3 middle(shape.half_width_mm * t, shape.length_mm * t * t, 0.0);
      mesh.vertices.push_back(middle + v * normal + Vec3(0.0, 0.0, z));
    }
  }
  const auto at = [&](int i, int j) { return std::int32_t(i * (across + 1) + j); };
  for (int i = 0; i < along; ++i)
    for (int j = 0; j < across; ++j)
      for (const geometry::Triangle& t :
           {geometry::Triangle{at(i, j), at(i + 1, j), at(i + 1, j + 1)},
            geometry::Triangle{at(i, j), at(i + 1, j + 1), at(i, j + 1)}})
        mesh.triangles.push_back(is_upper ? geometry::Triangle{t[0], t[2], t[1]} : t);
  return mesh;
}

}  // namespace lefort::test
