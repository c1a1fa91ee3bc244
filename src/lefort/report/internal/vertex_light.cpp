#include <lefort/core/parallel.h>
#include <lefort/report/internal/vertex_light.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

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

/// The k-th of n evenly distributed points of the unit disc (Vogel's spiral).
Eigen::Vector2d disc_point(int k, int n, double rotation) {
  const double golden_angle = std::numbers::pi * (3.0 - std::sqrt(5.0));
  const double radius = std::sqrt((double(k) + 0.5) / double(n));
  const double angle = golden_angle * double(k) + rotation;
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

/// Distance of ray origins from the surface, so that rays do not hit the triangles they leave.
double lift_mm(const geometry::TriangleMesh& mesh) {
  if (mesh.triangles.empty()) return 0.0;
  const double sum_mm = deterministic_sum(mesh.triangle_count(), 0.0, [&](Index t) {
    return (mesh.corner(t, 1) - mesh.corner(t, 0)).norm();
  });
  return std::min(0.5, 0.5 * sum_mm / double(mesh.triangle_count()));
}

/// Replaces each value by the mean over the vertex and its neighbors.
void smooth(std::vector<float>& values, const geometry::TriangleMesh& mesh) {
  std::vector<float> sums(values);
  std::vector<float> weights(values.size(), 1.0F);
  for (const geometry::Triangle& corners : mesh.triangles) {
    for (std::size_t c = 0; c < 3; ++c) {
      const auto here = std::size_t(corners[c]);
      sums[here] += values[std::size_t(corners[(c + 1) % 3])];
      sums[here] += values[std::size_t(corners[(c + 2) % 3])];
      weights[here] += 2.0F;
    }
  }
  for (std::size_t v = 0; v < values.size(); ++v) values[v] = sums[v] / weights[v];
}

/// fraction(v) for each vertex with a normal, 1 for the others; smoothed.
template <class Fraction>
Result<std::vector<float>> fraction_per_vertex(const geometry::TriangleMesh& mesh,
                                               const std::vector<Vec3>& normals_L,
                                               const Fraction& fraction, Progress& progress) {
  std::vector<float> fractions(normals_L.size(), 1.0F);
  const Index count = mesh.vertex_count();
  for (Index begin = 0; begin < count; begin += kSlice) {
    if (progress.stop_requested()) return fail(ErrorCode::kCancelled, "rendering was cancelled");
    progress.report(double(begin) / double(count));
    parallel_for(std::min(kSlice, count - begin), [&](Index offset) {
      const Index v = begin + offset;
      if (!normals_L[std::size_t(v)].isZero()) fractions[std::size_t(v)] = float(fraction(v));
    });
  }
  for (int n = 0; n < kSmoothings; ++n) smooth(fractions, mesh);
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

Result<std::vector<float>> ambient_occlusion(const geometry::TriangleMesh& mesh_L,
                                             const std::vector<Vec3>& normals_L,
                                             const RayScene& obstacles, double max_distance_mm,
                                             Progress& progress) {
  const double lift = lift_mm(mesh_L);
  const auto fraction = [&](Index v) {
    const Vec3& normal_L = normals_L[std::size_t(v)];
    const Vec3 origin_L = mesh_L.vertices[std::size_t(v)] + lift * normal_L;
    const Vec3 side_L = normal_L.unitOrthogonal();
    const Vec3 other_L = normal_L.cross(side_L);
    const double rotation = random_angle(v);
    int open = 0;
    for (int k = 0; k < kAmbientSamples; ++k) {
      // Points of a disc projected to the hemisphere are cosine-weighted directions (Malley).
      const Eigen::Vector2d flat = disc_point(k, kAmbientSamples, rotation);
      const Vec3 direction_L =
          flat.x() * side_L + flat.y() * other_L + std::sqrt(1.0 - flat.squaredNorm()) * normal_L;
      open += obstacles.blocked(origin_L, direction_L, max_distance_mm) ? 0 : 1;
    }
    return double(open) / kAmbientSamples;
  };
  return fraction_per_vertex(mesh_L, normals_L, fraction, progress);
}

Result<std::vector<float>> soft_shadow(const geometry::TriangleMesh& mesh_L,
                                       const std::vector<Vec3>& normals_L,
                                       const RayScene& obstacles, const Vec3& key_light_L,
                                       Progress& progress) {
  const double lift = lift_mm(mesh_L);
  const Vec3 side_L = key_light_L.unitOrthogonal();
  const Vec3 other_L = key_light_L.cross(side_L);
  const auto fraction = [&](Index v) {
    const Vec3& normal_L = normals_L[std::size_t(v)];
    if (normal_L.dot(key_light_L) < -kKeyLightRadius) return 0.0;  // The lamp is below the horizon.
    const Vec3 origin_L = mesh_L.vertices[std::size_t(v)] + lift * normal_L;
    const double rotation = random_angle(v);
    int open = 0;
    for (int k = 0; k < kKeyLightSamples; ++k) {
      const Eigen::Vector2d flat = kKeyLightRadius * disc_point(k, kKeyLightSamples, rotation);
      const Vec3 direction_L = (key_light_L + flat.x() * side_L + flat.y() * other_L).normalized();
      open +=
          obstacles.blocked(origin_L, direction_L, std::numeric_limits<double>::infinity()) ? 0 : 1;
    }
    return double(open) / kKeyLightSamples;
  };
  return fraction_per_vertex(mesh_L, normals_L, fraction, progress);
}

}  // namespace lefort::report
