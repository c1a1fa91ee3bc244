#include <lefort/core/parallel.h>
#include <lefort/dental/insertion_fit.h>
#include <lefort/geometry/mesh_properties.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lefort::dental {

double percentile(std::vector<double> values, double part) {
  std::erase_if(values, [](double value) { return std::isnan(value); });
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto n = std::ptrdiff_t(part * double(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + n, values.end());
  return values[std::size_t(n)];
}

InsertionFit insertion_fit(const geometry::TriangleMesh& base, const geometry::Bvh& body,
                           const std::vector<char>& covered, const Vec3& removal,
                           const Progress& progress) {
  constexpr double kWay_mm = 10.0, kStep_mm = 0.5;
  std::vector<double> clearances(base.vertices.size(), std::numeric_limits<double>::quiet_NaN());
  std::vector<double> depths(base.vertices.size(), 0.0);
  const Box3 box = geometry::bounding_box(body.mesh());
  parallel_for(base.vertex_count(), [&](Index v) {
    if (progress.stop_requested()) return;
    const Vec3& p = base.vertices[std::size_t(v)];
    if (covered[std::size_t(v)]) clearances[std::size_t(v)] = body.signed_distance(p).distance_mm;
    for (int n = 0; n <= int(kWay_mm / kStep_mm); ++n) {
      const Vec3 at = p - n * kStep_mm * removal;
      if (box.exteriorDistance(at) > 0.0) continue;
      depths[std::size_t(v)] =
          std::max(depths[std::size_t(v)], -body.signed_distance(at).distance_mm);
    }
  });
  return {percentile(clearances, 0.05), percentile(clearances, 0.5), percentile(clearances, 0.95),
          depths.empty() ? 0.0 : *std::max_element(depths.begin(), depths.end())};
}

}  // namespace lefort::dental
