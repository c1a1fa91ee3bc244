#include <lefort/core/parallel.h>
#include <lefort/geometry/bvh.h>
#include <lefort/geometry/mesh_properties.h>
#include <lefort/geometry/smooth_surface.h>
#include <lefort/mesh/finish_surface.h>
#include <lefort/mesh/self_intersections.h>
#include <lefort/mesh/simplify_surface.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace lefort::mesh {
namespace {

/// \returns the distances of the vertices of one surface from the other, ascending.
std::vector<double> distances_mm(const geometry::TriangleMesh& from, const geometry::Bvh& onto) {
  std::vector<double> distances(from.vertices.size());
  parallel_for(from.vertex_count(), [&](Index v) {
    distances[std::size_t(v)] = onto.closest_point(from.vertices[std::size_t(v)])->distance_mm;
  });
  std::sort(distances.begin(), distances.end());
  return distances;
}

}  // namespace

Result<FinishedSurface> finish_surface(const geometry::TriangleMesh& isosurface_L, double voxel_mm,
                                       const SurfaceFinish& options, Progress& progress) {
  FinishedSurface finished;
  finished.mesh_L = geometry::smooth_surface(
      isosurface_L, {.passes = options.smoothing_passes, .max_mm = 0.5 * voxel_mm});
  if (options.triangles) {
    LEFORT_TRY(finished.mesh_L, simplify_surface(finished.mesh_L, *options.triangles, progress));
  }
  finished.is_closed = geometry::is_closed(finished.mesh_L);
  LEFORT_TRY(finished.self_intersections, count_self_intersections(finished.mesh_L));
  const geometry::Bvh before(isosurface_L), after(finished.mesh_L);
  for (const std::vector<double>& ascending :
       {distances_mm(finished.mesh_L, before), distances_mm(isosurface_L, after)}) {
    finished.p99_off_mm = std::max(finished.p99_off_mm, ascending[ascending.size() * 99 / 100]);
    finished.max_off_mm = std::max(finished.max_off_mm, ascending.back());
  }
  return finished;
}

}  // namespace lefort::mesh
