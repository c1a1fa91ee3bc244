#include <lefort/geometry/tube_surface.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

namespace lefort::geometry {
namespace {

std::vector<Vec3> tangents_of(std::span<const Vec3> line_L) {
  std::vector<Vec3> tangents(line_L.size());
  for (std::size_t n = 0; n < line_L.size(); ++n) {
    const Vec3& from = line_L[n > 0 ? n - 1 : 0];
    const Vec3& to = line_L[n + 1 < line_L.size() ? n + 1 : n];
    tangents[n] = (to - from).normalized();
  }
  return tangents;
}

/// v, reflected at the plane normal to `normal`.
Vec3 reflected(const Vec3& v, const Vec3& normal) {
  const double square = normal.squaredNorm();
  return square > 0.0 ? Vec3(v - 2.0 / square * normal.dot(v) * normal) : v;
}

/// A unit vector normal to each tangent, without twist.
std::vector<Vec3> normals_of(std::span<const Vec3> line_L, const std::vector<Vec3>& tangents) {
  std::vector<Vec3> normals{tangents.front().unitOrthogonal()};
  for (std::size_t n = 1; n < line_L.size(); ++n) {
    const Vec3 chord = line_L[n] - line_L[n - 1];
    const Vec3 tangent = reflected(tangents[n - 1], chord);
    normals.push_back(
        reflected(reflected(normals.back(), chord), tangents[n] - tangent).normalized());
  }
  return normals;
}

}  // namespace

TriangleMesh tube_surface(std::span<const Vec3> line_L, double radius_mm, int corners) {
  const std::vector<Vec3> tangents = tangents_of(line_L);
  const std::vector<Vec3> normals = normals_of(line_L, tangents);
  TriangleMesh tube;
  const auto count = std::int32_t(line_L.size());
  for (std::size_t n = 0; n < line_L.size(); ++n) {
    const Vec3 other = tangents[n].cross(normals[n]);
    for (int c = 0; c < corners; ++c) {
      const double angle = 2.0 * std::numbers::pi * double(c) / double(corners);
      tube.vertices.emplace_back(
          line_L[n] + radius_mm * (std::cos(angle) * normals[n] + std::sin(angle) * other));
    }
  }
  const std::int32_t first = count * corners, last = first + 1;
  tube.vertices.push_back(line_L.front());
  tube.vertices.push_back(line_L.back());
  for (std::int32_t n = 0; n + 1 < count; ++n)
    for (std::int32_t c = 0; c < corners; ++c) {
      const std::int32_t next = (c + 1) % corners, a = n * corners, b = a + corners;
      tube.triangles.push_back({a + c, a + next, b + c});
      tube.triangles.push_back({a + next, b + next, b + c});
    }
  const std::int32_t end = (count - 1) * corners;
  for (std::int32_t c = 0; c < corners; ++c) {
    const std::int32_t next = (c + 1) % corners;
    tube.triangles.push_back({first, next, c});
    tube.triangles.push_back({last, end + c, end + next});
  }
  return tube;
}

}  // namespace lefort::geometry
