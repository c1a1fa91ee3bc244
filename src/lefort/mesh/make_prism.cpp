#include <lefort/core/check.h>
#include <lefort/mesh/combine_solids.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace lefort::mesh {
namespace {

using geometry::TriangleMesh;
using Point2 = Eigen::Vector2d;
using Polygon = std::vector<Point2>;

/// Twice the signed area of a triangle: positive if counter-clockwise.
double turn(const Point2& a, const Point2& b, const Point2& c) {
  return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

double twice_area(const Polygon& polygon) {
  double sum = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point2& p = polygon[i];
    const Point2& q = polygon[(i + 1) % polygon.size()];
    sum += p.x() * q.y() - p.y() * q.x();
  }
  return sum;
}

bool is_between(const Point2& p, const Point2& a, const Point2& b) {
  return (p - a).dot(p - b) <= 0.0;
}

bool meet(const Point2& a, const Point2& b, const Point2& c, const Point2& d) {
  const double abc = turn(a, b, c), abd = turn(a, b, d), cda = turn(c, d, a), cdb = turn(c, d, b);
  if (((abc > 0) != (abd > 0)) && ((cda > 0) != (cdb > 0)) && abc != 0 && abd != 0 && cda != 0 &&
      cdb != 0)
    return true;
  return (abc == 0 && is_between(c, a, b)) || (abd == 0 && is_between(d, a, b)) ||
         (cda == 0 && is_between(a, c, d)) || (cdb == 0 && is_between(b, c, d));
}

/// Whether no side crosses or touches another, except its neighbors at the common corner.
bool is_simple(const Polygon& polygon) {
  const std::size_t n = polygon.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Point2 &a = polygon[i], &b = polygon[(i + 1) % n];
    if (a == b) return false;
    const Point2& after = polygon[(i + 2) % n];
    if (turn(a, b, after) == 0 && (after - b).dot(a - b) > 0) return false;  // Back on itself.
    for (std::size_t j = i + 2; j < n; ++j) {
      if ((j + 1) % n == i) continue;
      if (meet(a, b, polygon[j], polygon[(j + 1) % n])) return false;
    }
  }
  return true;
}

/// Triangulates by ear clipping. \pre Simple and counter-clockwise.
std::vector<geometry::Triangle> triangulate(const Polygon& polygon) {
  std::vector<std::int32_t> rest(polygon.size());
  std::iota(rest.begin(), rest.end(), 0);
  const auto at = [&](std::int32_t i) { return polygon[std::size_t(i)]; };
  std::vector<geometry::Triangle> triangles;
  while (rest.size() > 3) {
    std::size_t ear = rest.size();
    double best = 0.0;
    for (std::size_t i = 0; i < rest.size(); ++i) {
      const std::int32_t a = rest[(i + rest.size() - 1) % rest.size()], b = rest[i],
                         c = rest[(i + 1) % rest.size()];
      const double area = turn(at(a), at(b), at(c));
      if (!(area > best)) continue;
      const bool is_empty = std::none_of(rest.begin(), rest.end(), [&](std::int32_t p) {
        return p != a && p != b && p != c && turn(at(a), at(b), at(p)) >= 0 &&
               turn(at(b), at(c), at(p)) >= 0 && turn(at(c), at(a), at(p)) >= 0;
      });
      if (!is_empty) continue;
      best = area;
      ear = i;
    }
    if (ear == rest.size()) {  // Only ears without area remain, at collinear corners.
      for (ear = 0; ear + 1 < rest.size(); ++ear)
        if (turn(at(rest[(ear + rest.size() - 1) % rest.size()]), at(rest[ear]),
                 at(rest[(ear + 1) % rest.size()])) == 0)
          break;
    }
    const std::size_t before = (ear + rest.size() - 1) % rest.size();
    triangles.push_back({rest[before], rest[ear], rest[(ear + 1) % rest.size()]});
    rest.erase(rest.begin() + std::ptrdiff_t(ear));
  }
  triangles.push_back({rest[0], rest[1], rest[2]});
  return triangles;
}

/// Offsets every side outwards. \pre Counter-clockwise.
Polygon grown(const Polygon& polygon, double by_mm) {
  // Cosine of half the turning angle at a corner: limits miters to 4 times the offset.
  constexpr double kMinMiterCosine = 0.25;
  Polygon result;
  const std::size_t n = polygon.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Point2 in = (polygon[i] - polygon[(i + n - 1) % n]).normalized();
    const Point2 out = (polygon[(i + 1) % n] - polygon[i]).normalized();
    const Point2 normal_in(in.y(), -in.x()), normal_out(out.y(), -out.x());
    const Point2 sum = normal_in + normal_out;
    const Point2 middle = sum.norm() > 1e-9 ? Point2(sum.normalized()) : in;
    result.push_back(polygon[i] +
                     by_mm / std::max(middle.dot(normal_in), kMinMiterCosine) * middle);
  }
  return result;
}

}  // namespace

Result<TriangleMesh> make_prism(std::span<const Vec3> curve, const Vec3& direction, double from_mm,
                                double to_mm, double grow_mm) {
  LEFORT_CHECK(from_mm < to_mm && grow_mm >= 0.0);
  const auto bad = [](std::string what) {
    return fail(ErrorCode::kInvalidArgument, std::move(what));
  };
  if (curve.size() < 3)
    return bad(fmt::format("the curve has {} points, must have three or more", curve.size()));
  if (!direction.allFinite() || !(direction.norm() > 1e-9))
    return bad("the curve's direction has no length");
  const Vec3 up = direction.normalized();
  const Vec3 across = up.unitOrthogonal(), along = up.cross(across);
  Polygon polygon;
  for (std::size_t i = 0; i < curve.size(); ++i) {
    if (!curve[i].allFinite()) return bad(fmt::format("the curve's point {} is not finite", i));
    polygon.emplace_back(across.dot(curve[i]), along.dot(curve[i]));
  }
  if (!is_simple(polygon))
    return bad("the curve, projected along its direction, crosses or touches itself");
  if (twice_area(polygon) < 0.0) std::reverse(polygon.begin(), polygon.end());
  if (grow_mm > 0.0) {
    polygon = grown(polygon, grow_mm);
    if (!is_simple(polygon))
      return bad("the curve, projected and widened by the kerf, crosses itself");
  }

  TriangleMesh prism;
  const auto n = std::int32_t(polygon.size());
  for (const double height_mm : {from_mm, to_mm})
    for (const Point2& p : polygon)
      prism.vertices.push_back(p.x() * across + p.y() * along + height_mm * up);
  for (const auto& [a, b, c] : triangulate(polygon)) {
    prism.triangles.push_back({a, c, b});
    prism.triangles.push_back({a + n, b + n, c + n});
  }
  for (std::int32_t i = 0; i < n; ++i) {
    const std::int32_t next = (i + 1) % n;
    prism.triangles.push_back({i, next, next + n});
    prism.triangles.push_back({i, next + n, i + n});
  }
  return prism;
}

}  // namespace lefort::mesh
