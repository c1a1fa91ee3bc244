#include <lefort/io/internal/surface_formats.h>

#include <cmath>

namespace lefort::io::internal {
namespace {

// Ear clipping of larger polygons takes too long; they do not occur in valid files.
constexpr std::size_t kMaxCorners = 1000;

using Point = Eigen::Vector2d;

/// Returns twice the area of a triangle, positive if counter-clockwise.
double twice_area(const Point& a, const Point& b, const Point& c) {
  return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

/// Projects the polygon along its normal, so that it is counter-clockwise.
std::vector<Point> flattened(std::span<const std::int32_t> corners, const SurfaceFile& surface) {
  const auto at = [&](std::size_t n) -> const Vec3& {
    return surface.vertices[std::size_t(corners[n % corners.size()])];
  };
  Vec3 normal = Vec3::Zero();
  for (std::size_t n = 1; n + 1 < corners.size(); ++n)
    normal += (at(n) - at(0)).cross(at(n + 1) - at(0));
  Index axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  Index u = (axis + 1) % 3;
  Index v = (axis + 2) % 3;
  if (normal[axis] < 0.0) std::swap(u, v);
  std::vector<Point> points;
  for (std::size_t n = 0; n < corners.size(); ++n) points.emplace_back(at(n)[u], at(n)[v]);
  return points;
}

/// Whether the corner between `before` and `after` is an ear: it is convex, and no other corner of
/// `left` lies in its triangle.
bool is_ear(const std::vector<Point>& points, const std::vector<std::size_t>& left,
            std::size_t before, std::size_t ear, std::size_t after) {
  const Point& a = points[before];
  const Point& b = points[ear];
  const Point& c = points[after];
  if (twice_area(a, b, c) <= 0.0) return false;
  for (const std::size_t n : left) {
    if (n == before || n == ear || n == after) continue;
    const Point& p = points[n];
    if (twice_area(a, b, p) >= 0.0 && twice_area(b, c, p) >= 0.0 && twice_area(c, a, p) >= 0.0)
      return false;
  }
  return true;
}

}  // namespace

void add_polygon(std::span<const std::int32_t> corners, SurfaceFile& surface) {
  std::vector<std::size_t> left(corners.size());
  bool all_known = true;
  for (std::size_t n = 0; n < corners.size(); ++n) {
    left[n] = n;
    all_known &= corners[n] >= 0 && Index(corners[n]) < Index(surface.vertices.size());
  }
  if (corners.size() > 3 && corners.size() <= kMaxCorners && all_known) {
    const std::vector<Point> points = flattened(corners, surface);
    for (std::size_t tried = 0, n = 0; left.size() > 3 && tried < left.size(); ++tried) {
      const std::size_t before = left[(n + left.size() - 1) % left.size()];
      const std::size_t ear = left[n % left.size()];
      const std::size_t after = left[(n + 1) % left.size()];
      if (is_ear(points, left, before, ear, after)) {
        surface.triangles.push_back({corners[before], corners[ear], corners[after]});
        left.erase(left.begin() + std::ptrdiff_t(n % left.size()));
        tried = 0;
      } else {
        ++n;
      }
    }
  }
  // The remainder: a triangle, or a polygon without ears, which is not planar.
  for (std::size_t n = 2; n < left.size(); ++n)
    surface.triangles.push_back({corners[left[0]], corners[left[n - 1]], corners[left[n]]});
}

}  // namespace lefort::io::internal
