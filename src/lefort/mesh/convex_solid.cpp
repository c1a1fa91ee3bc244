#include <lefort/mesh/convex_solid.h>
#include <lefort/mesh/internal/cgal_surface.h>

#include <CGAL/convex_hull_3.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lefort::mesh {
namespace {

/// normal . p >= offset, normal of unit length.
struct Plane {
  Vec3 normal;
  double offset;
};

std::vector<Plane> planes_of(std::span<const HalfSpace> half_spaces, const Box3& box) {
  std::vector<Plane> planes;
  for (const HalfSpace& half : half_spaces) {
    const Vec3 normal = half.normal.normalized();
    planes.push_back({normal, normal.dot(half.point)});
  }
  for (int axis = 0; axis < 3; ++axis) {
    planes.push_back({Vec3::Unit(axis), box.min()[axis]});
    planes.push_back({-Vec3::Unit(axis), -box.max()[axis]});
  }
  return planes;
}

/// \returns the corners of the solid: points on three planes and inside the others.
std::vector<Vec3> corners_of(const std::vector<Plane>& planes, double tolerance_mm) {
  constexpr double kMinDeterminant = 1e-9;  // Of unit normals; below it planes count as parallel.
  std::vector<Vec3> corners;
  const auto add = [&](const Plane& a, const Plane& b, const Plane& c) {
    Mat3 normals;
    normals << a.normal.transpose(), b.normal.transpose(), c.normal.transpose();
    if (std::abs(normals.determinant()) < kMinDeterminant) return;
    const Vec3 p = normals.inverse() * Vec3(a.offset, b.offset, c.offset);
    for (const Plane& plane : planes)
      if (plane.normal.dot(p) < plane.offset - tolerance_mm) return;
    for (const Vec3& other : corners)
      if ((other - p).norm() < tolerance_mm) return;
    corners.push_back(p);
  };
  for (std::size_t i = 0; i < planes.size(); ++i)
    for (std::size_t j = i + 1; j < planes.size(); ++j)
      for (std::size_t k = j + 1; k < planes.size(); ++k) add(planes[i], planes[j], planes[k]);
  return corners;
}

/// \returns the thickness of the thinnest slab, parallel to one of the planes, that contains all
/// corners.
double thickness_mm(const std::vector<Vec3>& corners, const std::vector<Plane>& planes) {
  double thinnest = std::numeric_limits<double>::infinity();
  for (const Plane& plane : planes) {
    double farthest = 0.0;
    for (const Vec3& p : corners) farthest = std::max(farthest, plane.normal.dot(p) - plane.offset);
    thinnest = std::min(thinnest, farthest);
  }
  return thinnest;
}

}  // namespace

geometry::TriangleMesh convex_solid(std::span<const HalfSpace> half_spaces, const Box3& box) {
  const std::vector<Plane> planes = planes_of(half_spaces, box);
  const double tolerance_mm = 1e-10 * box.sizes().norm();
  const std::vector<Vec3> corners = corners_of(planes, tolerance_mm);
  if (corners.size() < 4 || thickness_mm(corners, planes) < 10.0 * tolerance_mm) return {};

  const internal::QuietCgal quiet;
  std::vector<internal::Kernel::Point_3> points;
  for (const Vec3& p : corners) points.emplace_back(p.x(), p.y(), p.z());
  internal::CgalSurface hull;
  CGAL::convex_hull_3(points.begin(), points.end(), hull);
  return internal::from_cgal(hull);
}

}  // namespace lefort::mesh
