#include <lefort/plan/internal/find_extremum.h>

#include <algorithm>
#include <cmath>

namespace lefort::plan::internal {

std::optional<Extremum> find_extremum(std::span<const Vec3> points, const Vec3& direction,
                                      double voxel_mm) {
  constexpr double kNeighborhood_mm = 10.0, kCore = 0.25;
  if (points.empty()) return std::nullopt;
  const Vec3 first = *std::max_element(
      points.begin(), points.end(),
      [&](const Vec3& a, const Vec3& b) { return direction.dot(a) < direction.dot(b); });
  const double highest_mm = direction.dot(first);
  const auto visit_near = [&](double within_mm, const auto& visit) {
    for (const Vec3& p : points)
      if (direction.dot(p) >= highest_mm - within_mm && (p - first).norm() <= kNeighborhood_mm)
        visit(p);
  };
  Vec3 mean = Vec3::Zero();
  double total = 0.0;
  visit_near(kCore * voxel_mm, [&](const Vec3& p) {
    const double weight = 1.0 - (highest_mm - direction.dot(p)) / (kCore * voxel_mm);
    mean += weight * p;
    total += weight;
  });
  mean /= total;
  Extremum found{first, 0.0};
  double square = 0.0;
  Index count = 0;
  visit_near(voxel_mm, [&](const Vec3& p) {
    square += (p - mean).squaredNorm();
    ++count;
    if ((p - mean).norm() < (found.point - mean).norm()) found.point = p;
  });
  found.spread_mm = std::sqrt(square / double(count));
  return found;
}

std::optional<Extremum> find_deepest(std::span<const Vec3> profile, const Vec3& one,
                                     const Vec3& two, double voxel_mm) {
  const Vec3 chord(0.0, two.y() - one.y(), two.z() - one.z());
  Vec3 normal(0.0, chord.z(), -chord.y());
  if (normal.norm() == 0.0) return std::nullopt;
  normal.normalize();
  if (normal.y() < 0.0) normal = -normal;
  return find_extremum(
      between_heights(profile, std::min(one.z(), two.z()), std::max(one.z(), two.z())), normal,
      voxel_mm);
}

std::vector<Vec3> between_heights(std::span<const Vec3> points, double low_mm, double high_mm) {
  std::vector<Vec3> inside;
  for (const Vec3& p : points)
    if (p.z() >= low_mm && p.z() <= high_mm) inside.push_back(p);
  return inside;
}

}  // namespace lefort::plan::internal
