#include <lefort/core/check.h>
#include <lefort/geometry/bvh.h>
#include <lefort/geometry/mesh_properties.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace lefort::geometry {

namespace {

constexpr std::int32_t kLeafTriangles = 4;
/// 2^31 triangles give 31 levels; a depth-first traversal keeps one node per level.
constexpr std::size_t kStackSize = 64;
/// Reduces box distances against rounding, so that a triangle at exactly equal distance is not
/// lost.
constexpr double kPrune = 1.0 - 1e-12;

double squared_distance_to_box(const Vec3& p, const Vec3& low, const Vec3& high) {
  return (low - p).cwiseMax(p - high).cwiseMax(0.0).squaredNorm();
}

bool ray_meets_box(const Vec3& origin, const Vec3& inverse, const Vec3& low, const Vec3& high) {
  double enter = 0.0, leave = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const double a = (low[k] - origin[k]) * inverse[k], b = (high[k] - origin[k]) * inverse[k];
    if (std::isnan(a) || std::isnan(b)) continue;  // The ray lies in a face of the slab.
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter <= leave * (1.0 + 1e-12);
}

/// Distance along the ray to the triangle, if the ray hits it (Moeller and Trumbore 1997).
std::optional<double> ray_meets_triangle(const Vec3& origin, const Vec3& direction, const Vec3& a,
                                         const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, from_a = origin - a;
  const Vec3 p = direction.cross(ac);
  const double determinant = ab.dot(p);
  if (determinant == 0.0) return std::nullopt;
  const double u = from_a.dot(p) / determinant;
  const Vec3 q = from_a.cross(ab);
  const double v = direction.dot(q) / determinant;
  const double along = ac.dot(q) / determinant;
  if (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && along >= 0.0) return along;
  return std::nullopt;
}

}  // namespace

Bvh::Bvh(TriangleMesh mesh) : mesh_(std::move(mesh)) {
  LEFORT_CHECK(check_surface(mesh_).has_value());
  pseudonormals_ = Pseudonormals(mesh_);
  order_.resize(mesh_.triangles.size());
  std::iota(order_.begin(), order_.end(), 0);
  std::vector<Vec3> centers;
  for (Index t = 0; t < mesh_.triangle_count(); ++t)
    centers.push_back((mesh_.corner(t, 0) + mesh_.corner(t, 1) + mesh_.corner(t, 2)) / 3.0);
  nodes_.reserve(order_.size());
  build(centers, 0, std::int32_t(order_.size()));
}

void Bvh::build(const std::vector<Vec3>& centers, std::int32_t begin, std::int32_t end) {
  Box3 box, center_box;
  for (std::int32_t i = begin; i < end; ++i) {
    const Index t = order_[std::size_t(i)];
    for (int k = 0; k < 3; ++k) box.extend(mesh_.corner(t, k));
    center_box.extend(centers[std::size_t(t)]);
  }
  const std::size_t node = nodes_.size();
  nodes_.push_back({box.min(), box.max(), begin, end - begin});
  if (end - begin <= kLeafTriangles) {
    std::sort(order_.begin() + begin, order_.begin() + end);
    return;
  }
  Index axis = 0;
  center_box.sizes().maxCoeff(&axis);
  const std::int32_t middle = begin + (end - begin) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                   [&](std::int32_t s, std::int32_t t) {
                     const double x = centers[std::size_t(s)][axis];
                     const double y = centers[std::size_t(t)][axis];
                     return x != y ? x < y : s < t;
                   });
  build(centers, begin, middle);
  nodes_[node].first = std::int32_t(nodes_.size());
  nodes_[node].count = 0;
  build(centers, middle, end);
}

std::optional<SurfacePoint> Bvh::closest_point(const Vec3& p, double max_distance_mm) const {
  if (!p.allFinite()) return std::nullopt;
  std::optional<SurfacePoint> nearest;
  double best = max_distance_mm * max_distance_mm;

  std::array<std::pair<double, std::int32_t>, kStackSize> stack;
  std::size_t depth = 0;
  const auto distance_to = [&](std::int32_t n) {
    const Node& node = nodes_[std::size_t(n)];
    return kPrune * squared_distance_to_box(p, node.low, node.high);
  };
  stack[depth++] = {distance_to(0), 0};
  while (depth > 0) {
    const auto [distance2, n] = stack[--depth];
    if (distance2 > best) continue;
    const Node& node = nodes_[std::size_t(n)];
    if (node.count == 0) {
      std::pair<double, std::int32_t> near{distance_to(n + 1), n + 1};
      std::pair<double, std::int32_t> far{distance_to(node.first), node.first};
      if (far.first < near.first) std::swap(near, far);
      stack[depth++] = far;
      stack[depth++] = near;
      continue;
    }
    for (std::int32_t i = node.first; i < node.first + node.count; ++i) {
      const Index t = order_[std::size_t(i)];
      const TrianglePoint found =
          closest_point_on_triangle(p, mesh_.corner(t, 0), mesh_.corner(t, 1), mesh_.corner(t, 2));
      const double d2 = found.squared_distance_mm2;
      if (d2 > best || (d2 == best && nearest && t > nearest->triangle)) continue;
      best = d2;
      nearest = SurfacePoint{found.point, d2, t, found.feature};
    }
  }
  if (nearest) nearest->distance_mm = std::sqrt(nearest->distance_mm);
  return nearest;
}

SignedDistance Bvh::signed_distance(const Vec3& p) const {
  const std::optional<SurfacePoint> nearest = closest_point(p);
  LEFORT_CHECK(nearest.has_value());
  const Vec3 n = pseudonormals_.at(mesh_, nearest->triangle, nearest->feature);
  const bool inside = n.dot(p - nearest->point) < 0.0;
  return {inside ? -nearest->distance_mm : nearest->distance_mm, *nearest, n};
}

template <class OnTriangle>
void Bvh::visit_ray(const Vec3& origin, const Vec3& direction,
                    const OnTriangle& on_triangle) const {
  const Vec3 inverse = direction.cwiseInverse();
  std::array<std::int32_t, kStackSize> stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const std::int32_t n = stack[--depth];
    const Node& node = nodes_[std::size_t(n)];
    if (!ray_meets_box(origin, inverse, node.low, node.high)) continue;
    if (node.count == 0) {
      stack[depth++] = node.first;
      stack[depth++] = n + 1;
      continue;
    }
    for (std::int32_t i = node.first; i < node.first + node.count; ++i) {
      const Index t = order_[std::size_t(i)];
      const auto along = ray_meets_triangle(origin, direction, mesh_.corner(t, 0),
                                            mesh_.corner(t, 1), mesh_.corner(t, 2));
      if (along) on_triangle(t, *along);
    }
  }
}

std::optional<RayHit> Bvh::first_hit(const Vec3& origin, const Vec3& direction) const {
  LEFORT_CHECK(!direction.isZero(0.0));
  std::optional<RayHit> first;
  visit_ray(origin, direction.normalized(), [&](Index triangle, double along_mm) {
    const bool nearer = !first || along_mm < first->distance_mm ||
                        (along_mm == first->distance_mm && triangle < first->triangle);
    if (nearer) first = RayHit{along_mm, triangle};
  });
  return first;
}

Index Bvh::count_hits(const Vec3& origin, const Vec3& direction) const {
  LEFORT_CHECK(!direction.isZero(0.0));
  Index hits = 0;
  visit_ray(origin, direction.normalized(), [&](Index, double) { ++hits; });
  return hits;
}

std::size_t Bvh::tree_bytes() const {
  return nodes_.size() * sizeof(Node) + order_.size() * sizeof(order_[0]);
}

}  // namespace lefort::geometry
