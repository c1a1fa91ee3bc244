#include <lefort/geometry/closest_point.h>

#include <algorithm>
#include <array>
#include <limits>

namespace lefort::geometry {

namespace {

/// What |n|^2 must exceed: fourth power of the longest edge times the square of the ratio.
double min_squared_normal(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double longest =
      std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
  return kDegenerateHeightRatio * kDegenerateHeightRatio * longest * longest;
}

Feature edge_feature(int side) { return Feature(int(Feature::kEdge0) + side); }
Feature vertex_feature(int corner) { return Feature(int(Feature::kVertex0) + corner); }

TrianglePoint closest_point_on_side(const Vec3& p, const Vec3& from, const Vec3& to, int side) {
  const Vec3 edge = to - from;
  const double along = edge.dot(p - from);
  const double length2 = edge.squaredNorm();
  if (!(along > 0.0)) return {from, (p - from).squaredNorm(), vertex_feature(side)};
  if (along >= length2) return {to, (p - to).squaredNorm(), vertex_feature((side + 1) % 3)};
  const Vec3 point = from + along / length2 * edge;
  return {point, (p - point).squaredNorm(), edge_feature(side)};
}

}  // namespace

bool triangle_is_degenerate(const Vec3& a, const Vec3& b, const Vec3& c) {
  return !((b - a).cross(c - a).squaredNorm() > min_squared_normal(a, b, c));
}

TrianglePoint closest_point_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b,
                                        const Vec3& c) {
  const std::array<const Vec3*, 3> corners = {&a, &b, &c};
  const Vec3 n = (b - a).cross(c - a);
  const double n2 = n.squaredNorm();
  const bool degenerate = !(n2 > min_squared_normal(a, b, c));

  // The closest point lies on an edge that p is outside of, or else on the face. Testing edges with
  // the normal, not with products of barycentric coordinates, is exact for slivers, too.
  std::array<bool, 3> outside{};
  for (int side = 0; side < 3; ++side) {
    const Vec3& from = *corners[std::size_t(side)];
    const Vec3& to = *corners[std::size_t((side + 1) % 3)];
    outside[std::size_t(side)] = degenerate || n.cross(to - from).dot(p - from) < 0.0;
  }
  if (!outside[0] && !outside[1] && !outside[2]) {
    const double height = n.dot(p - a);
    return {p - height / n2 * n, height * height / n2, Feature::kFace};
  }

  TrianglePoint best{a, std::numeric_limits<double>::infinity(), Feature::kVertex0};
  for (int side = 0; side < 3; ++side) {
    if (!outside[std::size_t(side)]) continue;
    const TrianglePoint found = closest_point_on_side(p, *corners[std::size_t(side)],
                                                      *corners[std::size_t((side + 1) % 3)], side);
    if (found.squared_distance_mm2 < best.squared_distance_mm2) best = found;
  }
  return best;
}

}  // namespace lefort::geometry
