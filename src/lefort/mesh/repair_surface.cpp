#include <lefort/geometry/mesh_properties.h>
#include <lefort/mesh/internal/cgal_surface.h>
#include <lefort/mesh/repair_surface.h>

#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/repair_degeneracies.h>
#include <CGAL/Polygon_mesh_processing/stitch_borders.h>
#include <fmt/format.h>

#include <algorithm>

namespace lefort::mesh {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using geometry::Triangle;
using geometry::TriangleMesh;
using internal::CgalSurface;

/// Keeps the first of several triangles on the same three vertices; opposite duplicates, which
/// enclose nothing, are removed altogether.
void drop_duplicate_triangles(TriangleMesh& mesh) {
  struct Use {
    Triangle key;
    std::size_t triangle;
    bool even;  ///< An even permutation of its key.
  };
  std::vector<Use> uses;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    Triangle key{a, b, c};
    std::sort(key.begin(), key.end());
    uses.push_back({key, t, (a < b) + (b < c) + (c < a) == 2});
  }
  std::sort(uses.begin(), uses.end(), [](const Use& p, const Use& q) {
    return p.key != q.key ? p.key < q.key : p.triangle < q.triangle;
  });
  std::vector<bool> keep(mesh.triangles.size(), true);
  for (std::size_t first = 0; first < uses.size();) {
    std::size_t end = first;
    std::array<std::size_t, 2> count{0, 0};
    for (; end < uses.size() && uses[end].key == uses[first].key; ++end) {
      ++count[uses[end].even];
      keep[uses[end].triangle] = end == first;
    }
    if (count[0] == count[1]) keep[uses[first].triangle] = false;
    first = end;
  }
  mesh = geometry::keep_triangles(mesh, [&](Index t) { return keep[std::size_t(t)]; });
}

/// Duplicates vertices until the triangles form a surface, then stitches coincident edges.
CgalSurface make_manifold(const TriangleMesh& mesh) {
  std::vector<internal::Kernel::Point_3> points;
  for (const Vec3& p : mesh.vertices) points.emplace_back(p.x(), p.y(), p.z());
  std::vector<std::array<std::size_t, 3>> triangles;
  for (const auto& [a, b, c] : mesh.triangles)
    triangles.push_back({std::size_t(a), std::size_t(b), std::size_t(c)});

  pmp::orient_polygon_soup(points, triangles);
  CgalSurface surface;
  pmp::polygon_soup_to_polygon_mesh(points, triangles, surface);
  if (!CGAL::is_closed(surface)) pmp::stitch_borders(surface);
  return surface;
}

Result<TriangleMesh> not_closed(const TriangleMesh& mesh) {
  const auto edge = geometry::first_open_edge(mesh);
  if (!edge) return fail(ErrorCode::kMeshInvalid, "the surface encloses no volume");
  const Vec3 p = mesh.vertices[std::size_t(edge->from)];
  return fail(ErrorCode::kMeshInvalid,
              fmt::format("the surface is open: {} at ({:.2f}, {:.2f}, {:.2f}) mm, every edge must "
                          "have two",
                          geometry::describe(*edge), p.x(), p.y(), p.z()));
}

}  // namespace

Result<TriangleMesh> repair_surface(const TriangleMesh& surface) {
  LEFORT_TRY_VOID(geometry::check_surface(surface));
  const internal::QuietCgal quiet;
  try {
    TriangleMesh mesh = surface;
    if (!geometry::is_closed(mesh)) {
      mesh = geometry::weld_vertices(mesh);
      drop_duplicate_triangles(mesh);
    }
    const bool oriented = !geometry::first_unbalanced_edge(mesh);

    CgalSurface manifold = make_manifold(mesh);
    if (!CGAL::is_closed(manifold)) return not_closed(internal::from_cgal(manifold));
    pmp::remove_degenerate_faces(manifold);
    if (!oriented) pmp::orient_to_bound_a_volume(manifold);
    TriangleMesh repaired = internal::from_cgal(manifold);
    const double volume_mm3 = geometry::signed_volume_mm3(repaired);
    if (!(std::abs(volume_mm3) > 0.0) || !geometry::is_closed(repaired))
      return not_closed(repaired);
    if (volume_mm3 < 0.0)
      for (auto& [a, b, c] : repaired.triangles) std::swap(b, c);
    return repaired;
  } catch (const std::bad_alloc&) {
    return fail(
        ErrorCode::kMeshingFailed,
        fmt::format("repairing the surface of {} triangles needs more memory than available",
                    surface.triangle_count()));
  } catch (const CGAL::Failure_exception&) {  // A case that the steps above do not repair.
    return fail(ErrorCode::kMeshInvalid,
                fmt::format("the surface of {} triangles cannot be repaired to a closed one",
                            surface.triangle_count()));
  }
}

}  // namespace lefort::mesh
