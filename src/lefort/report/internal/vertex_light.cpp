#include <lefort/core/parallel.h>
#include <lefort/report/internal/vertex_light.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>

namespace lefort::report {

namespace {

constexpr int kAmbientSamples = 32;
constexpr int kKeyLightSamples = 12;
constexpr double kKeyLightRadius = 0.16;  ///< Tangent of the angular radius, 9 degrees.
constexpr int kSmoothings = 3;
constexpr Index kSlice = 8192;  ///< Vertices between two checks for a stop request.

/// A pseudorandom angle per vertex (Steele et al. 2014, splitmix64).
double random_angle(Index vertex) {
  std::uint64_t z = std::uint64_t(vertex) + 0x9e3779b97f4a7c15U;
  z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
  z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
  return 2.0 * std::numbers::pi * double((z ^ (z >> 31U)) >> 11U) * 0x1p-53;
}

/// Evenly distributed points of the unit disc (Vogel's spiral).
template <std::size_t n>
std::array<Eigen::Vector2d, n> disc_points() {
  const double golden_angle = std::numbers::pi * (3.0 - std::sqrt(5.0));
  std::array<Eigen::Vector2d, n> points;
  for (std::size_t k = 0; k < n; ++k) {
    const double radius = std::sqrt((double(k) + 0.5) / double(n));
    points[k] = radius * Eigen::Vector2d(std::cos(golden_angle * double(k)),
                                         std::sin(golden_angle * double(k)));
  }
  return points;
}

/// Distance of ray origins from the surface, so that rays do not hit the triangles they leave.
double lift_mm(const geometry::TriangleMesh& mesh) {
  if (mesh.triangles.empty()) return 0.0;
  const double sum_mm = deterministic_sum(mesh.triangle_count(), 0.0, [&](Index t) {
    return (mesh.corner(t, 1) - mesh.corner(t, 0)).norm();
  });
  return std::min(0.5, 0.5 * sum_mm / double(mesh.triangle_count()));
}

/// Replaces each value by the mean over the vertex and its neighbors in these triangles.
void smooth(std::vector<float>& values, const geometry::TriangleMesh& mesh,
            const LitRegion& region) {
  std::vector<float> sums(values);
  std::vector<float> weights(values.size(), 1.0F);
  for (const std::uint32_t triangle : region.triangles) {
    const geometry::Triangle& corners = mesh.triangles[triangle];
    for (std::size_t c = 0; c < 3; ++c) {
      const auto here = std::size_t(corners[c]);
      sums[here] += values[std::size_t(corners[(c + 1) % 3])];
      sums[here] += values[std::size_t(corners[(c + 2) % 3])];
      weights[here] += 2.0F;
    }
  }
  for (const std::int32_t v : region.vertices)
    values[std::size_t(v)] = sums[std::size_t(v)] / weights[std::size_t(v)];
}

/// fraction(v) for each vertex of the region with a normal, 1 for the others; smoothed.
template <class Fraction>
Result<std::vector<float>> fraction_per_vertex(const ShadedSurface& surface,
                                               const LitRegion& region, VertexFractions& known,
                                               const Fraction& fraction, Progress& progress) {
  const auto count = Index(region.vertices.size());
  for (Index begin = 0; begin < count; begin += kSlice) {
    if (progress.stop_requested()) return fail(ErrorCode::kCancelled, "rendering was cancelled");
    progress.report(double(begin) / double(count));
    parallel_for(std::min(kSlice, count - begin), [&](Index offset) {
      const auto v = std::size_t(region.vertices[std::size_t(begin + offset)]);
      if (known.is_known[v] != 0) return;
      known.is_known[v] = 1;
      if (!surface.normals_L[v].isZero()) known.values[v] = float(fraction(Index(v)));
    });
  }
  std::vector<float> fractions(known.values);
  for (int n = 0; n < kSmoothings; ++n) smooth(fractions, surface.mesh_L, region);
  return fractions;
}

}  // namespace

std::vector<Vec3> vertex_normals(const geometry::TriangleMesh& mesh_L) {
  std::vector<Vec3> normals_L(mesh_L.vertices.size(), Vec3::Zero());
  for (Index t = 0; t < mesh_L.triangle_count(); ++t) {
    const Vec3 area_L = (mesh_L.corner(t, 1) - mesh_L.corner(t, 0))
                            .cross(mesh_L.corner(t, 2) - mesh_L.corner(t, 0));
    for (const std::int32_t corner : mesh_L.triangles[std::size_t(t)])
      normals_L[std::size_t(corner)] += area_L;
  }
  for (Vec3& normal_L : normals_L) {
    const double length = normal_L.norm();
    normal_L = length > 0.0 ? Vec3(normal_L / length) : Vec3(Vec3::Zero());
  }
  return normals_L;
}

LitRegion lit_region(const geometry::TriangleMesh& mesh_L, std::span<const char> visible) {
  std::vector<char> is_lit(mesh_L.vertices.size(), 0);
  const auto mark = [&](std::vector<char>& marks, std::size_t t) {
    for (const std::int32_t corner : mesh_L.triangles[t]) marks[std::size_t(corner)] = 1;
  };
  const auto has_lit = [&](std::size_t t) {
    const geometry::Triangle& corners = mesh_L.triangles[t];
    return std::any_of(corners.begin(), corners.end(),
                       [&](std::int32_t corner) { return is_lit[std::size_t(corner)] != 0; });
  };
  for (std::size_t t = 0; t < mesh_L.triangles.size(); ++t)
    if (visible[t] != 0) mark(is_lit, t);
  for (int ring = 0; ring < kSmoothings; ++ring) {
    std::vector<char> wider(is_lit);
    for (std::size_t t = 0; t < mesh_L.triangles.size(); ++t)
      if (has_lit(t)) mark(wider, t);
    is_lit = std::move(wider);
  }
  LitRegion region;
  for (std::size_t v = 0; v < is_lit.size(); ++v)
    if (is_lit[v] != 0) region.vertices.push_back(std::int32_t(v));
  for (std::size_t t = 0; t < mesh_L.triangles.size(); ++t)
    if (has_lit(t)) region.triangles.push_back(std::uint32_t(t));
  return region;
}

Result<std::vector<float>> ambient_occlusion(const ShadedSurface& surface, const LitRegion& region,
                                             double max_distance_mm, VertexFractions& known,
                                             Progress& progress) {
  static const auto pattern = disc_points<kAmbientSamples>();
  const double lift = lift_mm(surface.mesh_L);
  const auto fraction = [&](Index v) {
    const Vec3& normal_L = surface.normals_L[std::size_t(v)];
    const Vec3 side_L = normal_L.unitOrthogonal();
    const Vec3 other_L = normal_L.cross(side_L);
    const Eigen::Rotation2Dd rotation(random_angle(v));
    const Eigen::Matrix2d turn = rotation.toRotationMatrix();
    std::array<Vec3, kAmbientSamples> directions_L;
    for (std::size_t k = 0; k < pattern.size(); ++k) {
      // Points of a disc projected to the hemisphere are cosine-weighted directions (Malley).
      const Eigen::Vector2d flat = turn * pattern[k];
      directions_L[k] =
          flat.x() * side_L + flat.y() * other_L + std::sqrt(1.0 - flat.squaredNorm()) * normal_L;
    }
    return double(surface.obstacles.count_open(
               surface.mesh_L.vertices[std::size_t(v)] + lift * normal_L, directions_L,
               max_distance_mm)) /
           kAmbientSamples;
  };
  return fraction_per_vertex(surface, region, known, fraction, progress);
}

Result<std::vector<float>> soft_shadow(const ShadedSurface& surface, const LitRegion& region,
                                       const Vec3& key_light_L, VertexFractions& known,
                                       Progress& progress) {
  static const auto pattern = disc_points<kKeyLightSamples>();
  const double lift = lift_mm(surface.mesh_L);
  const Vec3 side_L = key_light_L.unitOrthogonal();
  const Vec3 other_L = key_light_L.cross(side_L);
  const auto fraction = [&](Index v) {
    const Vec3& normal_L = surface.normals_L[std::size_t(v)];
    if (normal_L.dot(key_light_L) < -kKeyLightRadius) return 0.0;  // The lamp is below the horizon.
    const Eigen::Rotation2Dd rotation(random_angle(v));
    const Eigen::Matrix2d turn = kKeyLightRadius * rotation.toRotationMatrix();
    std::array<Vec3, kKeyLightSamples> directions_L;
    for (std::size_t k = 0; k < pattern.size(); ++k) {
      const Eigen::Vector2d flat = turn * pattern[k];
      directions_L[k] = (key_light_L + flat.x() * side_L + flat.y() * other_L).normalized();
    }
    return double(surface.obstacles.count_open(
               surface.mesh_L.vertices[std::size_t(v)] + lift * normal_L, directions_L,
               std::numeric_limits<double>::infinity())) /
           kKeyLightSamples;
  };
  return fraction_per_vertex(surface, region, known, fraction, progress);
}

}  // namespace lefort::report
