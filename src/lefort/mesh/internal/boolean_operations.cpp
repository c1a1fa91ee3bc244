#include <lefort/mesh/internal/boolean_operations.h>
#include <lefort/mesh/internal/cgal_surface.h>

#include <CGAL/Polygon_mesh_processing/corefinement.h>

#include <array>

namespace lefort::mesh::internal {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;

}  // namespace

BooleanResult boolean_operations(const geometry::TriangleMesh& first,
                                 const geometry::TriangleMesh& second,
                                 const BooleanRequest& wanted) {
  const QuietCgal quiet;
  CgalSurface a = to_cgal(first), b = to_cgal(second), either, both, first_only;
  std::array<boost::optional<CgalSurface*>, 4> outputs;
  if (wanted.in_either) outputs[pmp::Corefinement::UNION] = &either;
  if (wanted.in_both) outputs[pmp::Corefinement::INTERSECTION] = &both;
  if (wanted.in_first_only) outputs[pmp::Corefinement::TM1_MINUS_TM2] = &first_only;
  try {
    const auto made = pmp::corefine_and_compute_boolean_operations(
        a, b, outputs, pmp::parameters::throw_on_self_intersection(true));
    const auto result = [&](bool is_wanted, int operation, const CgalSurface& surface) {
      std::optional<geometry::TriangleMesh> mesh;
      if (is_wanted && made[std::size_t(operation)]) mesh = from_cgal(surface);
      return mesh;
    };
    return {result(wanted.in_either, pmp::Corefinement::UNION, either),
            result(wanted.in_both, pmp::Corefinement::INTERSECTION, both),
            result(wanted.in_first_only, pmp::Corefinement::TM1_MINUS_TM2, first_only)};
  } catch (const pmp::Corefinement::Self_intersection_exception&) {
  } catch (const CGAL::Failure_exception&) {  // A violated precondition of CGAL.
  }
  return {};
}

}  // namespace lefort::mesh::internal
