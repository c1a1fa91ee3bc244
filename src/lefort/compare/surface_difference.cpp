#include <lefort/compare/surface_difference.h>
#include <lefort/core/parallel.h>
#include <lefort/geometry/edge_incidence.h>

#include <array>
#include <limits>

namespace lefort::compare {
namespace {

using geometry::Feature;
using geometry::TriangleMesh;

/// The boundary edges of a surface.
class BoundaryEdges {
 public:
  explicit BoundaryEdges(const TriangleMesh& mesh)
      : is_boundary_side_(mesh.triangles.size(), {false, false, false}),
        is_on_boundary_(mesh.vertices.size(), false) {
    const geometry::EdgeIncidence edges(mesh);
    for (Index v = 0; v < mesh.vertex_count(); ++v)
      edges.for_each_edge_at(std::int32_t(v), [&](auto smaller, auto larger, auto sides) {
        if (sides.size() != 1) return;
        is_boundary_side_[std::size_t(sides[0].triangle())][std::size_t(sides[0].side())] = true;
        is_on_boundary_[std::size_t(smaller)] = is_on_boundary_[std::size_t(larger)] = true;
      });
  }

  [[nodiscard]] bool contains(const TriangleMesh& mesh, const geometry::SurfacePoint& p) const {
    const auto number = std::size_t(geometry::number_of(p.feature));
    if (geometry::is_edge(p.feature)) return is_boundary_side_[std::size_t(p.triangle)][number];
    if (!geometry::is_vertex(p.feature)) return false;
    return is_on_boundary_[std::size_t(mesh.triangles[std::size_t(p.triangle)][number])];
  }

 private:
  std::vector<std::array<bool, 3>> is_boundary_side_;
  std::vector<bool> is_on_boundary_;
};

}  // namespace

std::vector<double> vertex_areas(const TriangleMesh& mesh) {
  std::vector<double> areas_mm2(mesh.vertices.size(), 0.0);
  for (Index t = 0; t < mesh.triangle_count(); ++t) {
    const Vec3 twice =
        (mesh.corner(t, 1) - mesh.corner(t, 0)).cross(mesh.corner(t, 2) - mesh.corner(t, 0));
    for (const std::int32_t v : mesh.triangles[std::size_t(t)])
      areas_mm2[std::size_t(v)] += twice.norm() / 6.0;
  }
  return areas_mm2;
}

SurfaceDifference measure_difference(const TriangleMesh& from, const geometry::Bvh& onto,
                                     const DifferenceOptions& options) {
  LEFORT_CHECK(options.max_mm > 0.0);
  const BoundaryEdges boundary(onto.mesh());
  const geometry::Pseudonormals normals(from);
  SurfaceDifference difference;
  difference.area_mm2 = vertex_areas(from);
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  difference.signed_mm.assign(from.vertices.size(), kNone);
  difference.offset_mm.assign(from.vertices.size(), Vec3::Constant(kNone));
  parallel_for(from.vertex_count(), [&](Index v) {
    const Vec3& p = from.vertices[std::size_t(v)];
    const auto nearest = onto.closest_point(p, options.max_mm);
    if (!nearest || boundary.contains(onto.mesh(), *nearest)) return;
    const Vec3 there = onto.pseudonormals().at(onto.mesh(), nearest->triangle, nearest->feature);
    if (normals.at_vertex(from, v).dot(there) <= 0.0) return;
    const bool is_outside = there.dot(p - nearest->point) >= 0.0;
    difference.signed_mm[std::size_t(v)] =
        is_outside ? nearest->distance_mm : -nearest->distance_mm;
    difference.offset_mm[std::size_t(v)] = p - nearest->point;
  });
  return difference;
}

}  // namespace lefort::compare
