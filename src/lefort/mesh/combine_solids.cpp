#include <lefort/mesh/combine_solids.h>
#include <lefort/mesh/internal/cgal_surface.h>

#include <CGAL/Polygon_mesh_processing/corefinement.h>

namespace lefort::mesh {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using geometry::TriangleMesh;
using internal::CgalSurface;

template <class Operation>
Result<TriangleMesh> combine(const TriangleMesh& a, const TriangleMesh& b,
                             const Operation& operation) {
  const internal::QuietCgal quiet;
  CgalSurface first = internal::to_cgal(a), second = internal::to_cgal(b), result;
  try {
    if (operation(first, second, result)) return internal::from_cgal(result);
  } catch (const pmp::Corefinement::Self_intersection_exception&) {
  } catch (const CGAL::Failure_exception&) {  // A precondition of CGAL.
  }
  return fail(ErrorCode::kMeshingFailed,
              "the surfaces of a cut cannot be put together: they cross or touch along an edge");
}

}  // namespace

Result<TriangleMesh> unite(const TriangleMesh& a, const TriangleMesh& b) {
  if (a.triangles.empty()) return b;
  if (b.triangles.empty()) return a;
  return combine(a, b, [](CgalSurface& x, CgalSurface& y, CgalSurface& out) {
    return pmp::corefine_and_compute_union(x, y, out,
                                           pmp::parameters::throw_on_self_intersection(true));
  });
}

Result<TriangleMesh> intersect(const TriangleMesh& a, const TriangleMesh& b) {
  if (a.triangles.empty() || b.triangles.empty()) return TriangleMesh();
  return combine(a, b, [](CgalSurface& x, CgalSurface& y, CgalSurface& out) {
    return pmp::corefine_and_compute_intersection(
        x, y, out, pmp::parameters::throw_on_self_intersection(true));
  });
}

}  // namespace lefort::mesh
