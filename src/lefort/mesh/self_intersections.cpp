#include <lefort/geometry/mesh_properties.h>
#include <lefort/mesh/internal/cgal_surface.h>
#include <lefort/mesh/self_intersections.h>

#include <CGAL/box_intersection_d.h>
#include <CGAL/intersections.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

namespace lefort::mesh {
namespace {

using internal::Kernel;
using Point = Kernel::Point_3;
using Segment = Kernel::Segment_3;
using CgalTriangle = Kernel::Triangle_3;
using geometry::Triangle;
using Box = CGAL::Box_intersection_d::Box_with_handle_d<double, 3, const Triangle*>;

/// Corners of two triangles; the common ones come first, in the same order.
struct Pair {
  std::array<std::int32_t, 3> a, b;
  int shared = 0;
};

Pair matched(const Triangle& a, const Triangle& b) {
  Pair pair{a, b, 0};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      if (a[i] == b[j]) {
        const auto k = std::size_t(pair.shared++);
        // Corners from k on are not matched yet, so a swap does not change matched ones.
        std::swap(pair.a[k], *std::find(pair.a.begin(), pair.a.end(), a[i]));
        std::swap(pair.b[k], *std::find(pair.b.begin(), pair.b.end(), b[j]));
      }
  return pair;
}

class Crossings {
 public:
  explicit Crossings(const geometry::TriangleMesh& mesh) {
    points_.reserve(mesh.vertices.size());
    for (const Vec3& p : mesh.vertices) points_.emplace_back(p.x(), p.y(), p.z());
  }
  [[nodiscard]] bool has_area(const Triangle& t) const {
    return !CGAL::collinear(at(t[0]), at(t[1]), at(t[2]));
  }
  [[nodiscard]] CGAL::Bbox_3 box(const Triangle& t) const {
    return at(t[0]).bbox() + at(t[1]).bbox() + at(t[2]).bbox();
  }
  [[nodiscard]] bool cross(const Triangle& one, const Triangle& other) const {
    const auto [a, b, shared] = matched(one, other);
    const CgalTriangle first(at(a[0]), at(a[1]), at(a[2]));
    const CgalTriangle second(at(b[0]), at(b[1]), at(b[2]));
    switch (shared) {
      case 0:
        return CGAL::do_intersect(first, second);
      case 1:
        return CGAL::do_intersect(Segment(at(a[1]), at(a[2])), second) ||
               CGAL::do_intersect(Segment(at(b[1]), at(b[2])), first);
      case 2:
        // Folded onto each other: coplanar, and on the same side of their common edge.
        return CGAL::coplanar(at(a[0]), at(a[1]), at(a[2]), at(b[2])) &&
               CGAL::coplanar_orientation(at(a[0]), at(a[1]), at(a[2]), at(b[2])) == CGAL::POSITIVE;
      default:
        return true;
    }
  }

 private:
  [[nodiscard]] const Point& at(std::int32_t v) const { return points_[std::size_t(v)]; }
  std::vector<Point> points_;
};

}  // namespace

Result<Index> count_self_intersections(const geometry::TriangleMesh& surface) {
  LEFORT_TRY_VOID(geometry::check_surface(surface));
  const geometry::TriangleMesh welded = geometry::weld_vertices(surface);
  const Crossings crossings(welded);
  std::vector<Box> boxes;
  boxes.reserve(welded.triangles.size());
  for (const Triangle& t : welded.triangles)
    if (crossings.has_area(t)) boxes.emplace_back(crossings.box(t), &t);
  Index count = 0;
  CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), [&](const Box& a, const Box& b) {
    if (crossings.cross(*a.handle(), *b.handle())) ++count;
  });
  return count;
}

}  // namespace lefort::mesh
