#include <lefort/core/check.h>
#include <lefort/core/decompositions.h>
#include <lefort/core/parallel.h>
#include <lefort/geometry/pseudonormals.h>
#include <lefort/geometry/symmetry_plane.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace lefort::geometry {
namespace {

struct Pair {
  Vec3 point, opposite;  ///< The closest point to the mirrored point.
  Vec3 normal;           ///< Of the surface there, unit length.
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
    pairs[std::size_t(i)] = {p, found.point,
                             face_normal(surface.mesh(), found.triangle).normalized(),
                             found.distance_mm};
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

/// The plane with the residuals of these pairs.
SymmetryPlane with_residuals(const Vec3& point, const Vec3& normal, std::span<const Pair> pairs,
                             std::span<const double> weights) {
  double total = 0.0, square = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    total += weights[i];
    square += weights[i] * pairs[i].distance_mm * pairs[i].distance_mm;
  }
  return {point, normal, std::sqrt(square / total), total / double(pairs.size())};
}

/// The least sum of squared distances between points.
SymmetryPlane fit_to_points(std::span<const Pair> pairs, std::span<const double> weights,
                            const Vec3& direction) {
  double total = 0.0;
  Vec3 mean = Vec3::Zero();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    total += weights[i];
    mean += 0.5 * weights[i] * (pairs[i].point + pairs[i].opposite);
  }
  mean /= total;
  Mat3 moment = Mat3::Zero();
  for (std::size_t i = 0; i < pairs.size(); ++i)
    moment += weights[i] * (pairs[i].point - mean) * (pairs[i].opposite - mean).transpose();
  const Vec3 normal = symmetric_eigen(Mat3(0.5 * (moment + moment.transpose()))).vectors.col(0);
  return with_residuals(mean, normal.dot(direction) < 0.0 ? Vec3(-normal) : normal, pairs, weights);
}

/// One Gauss-Newton step of the least sum of squared distances from the surface's tangent planes:
/// r = n_q . (x - 2 (n . x - d) n - y), by a turn of n about two axes and by d.
SymmetryPlane fit_to_tangents(std::span<const Pair> pairs, std::span<const double> weights,
                              const SymmetryPlane& plane) {
  const Vec3& n = plane.normal;
  const Vec3 first = n.unitOrthogonal(), second = n.cross(first);
  Mat3 A = Mat3::Zero();
  Vec3 b = Vec3::Zero();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Pair& pair = pairs[i];
    const Vec3 x = pair.point - plane.point;
    const double height = n.dot(x);
    const double r = pair.normal.dot(mirrored(pair.point, plane) - pair.opposite);
    const auto by_turn = [&](const Vec3& dn) {
      return -2.0 * (dn.dot(x) * pair.normal.dot(n) + height * pair.normal.dot(dn));
    };
    const Vec3 J(by_turn(first), by_turn(second), 2.0 * pair.normal.dot(n));
    A += weights[i] * J * J.transpose();
    b -= weights[i] * r * J;
  }
  const Vec3 step = solve_by_lu(A, b);
  if (!step.allFinite()) return plane;
  const Vec3 normal = (n + step.x() * first + step.y() * second).normalized();
  return with_residuals(plane.point + step.z() * n, normal, pairs, weights);
}

}  // namespace

SymmetryPlane fit_symmetry_plane(const Bvh& surface, std::span<const Vec3> points,
                                 const SymmetryPlane& start) {
  constexpr int kMaxIterations = 60, kToPoints = 10;
  constexpr double kMinTurn = 1e-5, kMinShift_mm = 1e-3;
  LEFORT_CHECK(points.size() >= 100);
  SymmetryPlane plane = start;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    const std::vector<Pair> pairs = pairs_of(surface, points, plane);
    const std::vector<double> weights = weights_of(pairs);
    const SymmetryPlane next = iteration < kToPoints ? fit_to_points(pairs, weights, start.normal)
                                                     : fit_to_tangents(pairs, weights, plane);
    const bool is_done = iteration > kToPoints && (next.normal - plane.normal).norm() < kMinTurn &&
                         std::abs(next.normal.dot(next.point - plane.point)) < kMinShift_mm;
    plane = next;
    if (is_done) break;
  }
  return plane;
}

}  // namespace lefort::geometry
