#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/geometry/symmetry_plane.h>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <vector>

namespace lefort::geometry {
namespace {

struct Pair {
  Vec3 point, opposite;
  double distance_mm;
};

Vec3 mirrored(const Vec3& p, const SymmetryPlane& plane) {
  return p - 2.0 * plane.normal.dot(p - plane.point) * plane.normal;
}

std::vector<Pair> pairs_of(const Bvh& surface, std::span<const Vec3> points,
                           const SymmetryPlane& plane) {
  std::vector<Pair> pairs(points.size());
  parallel_for(Index(points.size()), [&](Index i) {
    const Vec3& p = points[std::size_t(i)];
    const SurfacePoint found = *surface.closest_point(mirrored(p, plane));
    pairs[std::size_t(i)] = {p, found.point, found.distance_mm};
  });
  return pairs;
}

/// Tukey's weights with the usual width for the scale of the distances.
std::vector<double> weights_of(std::span<const Pair> pairs) {
  constexpr double kWidth = 4.685 * 1.4826;  // 95 % efficiency; from the median to sigma.
  constexpr double kMinWidth_mm = 1.0;
  std::vector<double> distances;
  distances.reserve(pairs.size());
  for (const Pair& pair : pairs) distances.push_back(pair.distance_mm);
  auto middle = distances.begin() + std::ptrdiff_t(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  const double width_mm = std::max(kWidth * *middle, kMinWidth_mm);
  std::vector<double> weights;
  weights.reserve(pairs.size());
  for (const Pair& pair : pairs) {
    const double u = std::min(pair.distance_mm / width_mm, 1.0);
    weights.push_back((1.0 - u * u) * (1.0 - u * u));
  }
  return weights;
}

SymmetryPlane fit_plane(std::span<const Pair> pairs, std::span<const double> weights,
                        const Vec3& direction) {
  double total = 0.0, square = 0.0;
  Vec3 mean = Vec3::Zero();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    total += weights[i];
    mean += 0.5 * weights[i] * (pairs[i].point + pairs[i].opposite);
    square += weights[i] * pairs[i].distance_mm * pairs[i].distance_mm;
  }
  mean /= total;
  Mat3 moment = Mat3::Zero();
  for (std::size_t i = 0; i < pairs.size(); ++i)
    moment += weights[i] * (pairs[i].point - mean) * (pairs[i].opposite - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(0.5 * (moment + moment.transpose()));
  const Vec3 normal = eigen.eigenvectors().col(0);
  return {mean, normal.dot(direction) < 0.0 ? Vec3(-normal) : normal, std::sqrt(square / total),
          total / double(pairs.size())};
}

}  // namespace

SymmetryPlane fit_symmetry_plane(const Bvh& surface, std::span<const Vec3> points,
                                 const SymmetryPlane& start) {
  constexpr int kMaxIterations = 60;
  constexpr double kMinTurn = 1e-5, kMinShift_mm = 1e-3;
  LEFORT_CHECK(points.size() >= 100);
  SymmetryPlane plane = start;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    const std::vector<Pair> pairs = pairs_of(surface, points, plane);
    const SymmetryPlane next = fit_plane(pairs, weights_of(pairs), start.normal);
    const bool is_done = (next.normal - plane.normal).norm() < kMinTurn &&
                         std::abs(next.normal.dot(next.point - plane.point)) < kMinShift_mm;
    plane = next;
    if (is_done) break;
  }
  return plane;
}

}  // namespace lefort::geometry
