#include <lefort/bench/surface_points.h>

#include <algorithm>
#include <random>

namespace lefort::bench {

std::vector<Vec3> points_near_surface(const geometry::TriangleMesh& mesh, Index count,
                                      double max_distance_mm, std::uint32_t seed) {
  std::vector<double> area_until;
  double total = 0.0;
  for (Index t = 0; t < mesh.triangle_count(); ++t) {
    const Vec3& a = mesh.corner(t, 0);
    total += (mesh.corner(t, 1) - a).cross(mesh.corner(t, 2) - a).norm();
    area_until.push_back(total);
  }
  // Not std::uniform_real_distribution: its numbers differ between standard libraries.
  std::mt19937 random(seed);
  const auto uniform = [&] { return double(random()) * 0x1p-32; };
  std::vector<Vec3> points;
  while (Index(points.size()) < count) {
    const auto found = std::upper_bound(area_until.begin(), area_until.end(), uniform() * total);
    const Index t = std::min<Index>(found - area_until.begin(), mesh.triangle_count() - 1);
    double u = uniform(), v = uniform();
    if (u + v > 1.0) {
      u = 1.0 - u;
      v = 1.0 - v;
    }
    const Vec3& a = mesh.corner(t, 0);
    const double x = 2.0 * uniform() - 1.0, y = 2.0 * uniform() - 1.0, z = 2.0 * uniform() - 1.0;
    const Vec3 off(x, y, z);
    if (off.squaredNorm() > 1.0) continue;  // Uniform in a ball.
    points.push_back(a + u * (mesh.corner(t, 1) - a) + v * (mesh.corner(t, 2) - a) +
                     max_distance_mm * off);
  }
  return points;
}

}  // namespace lefort::bench
