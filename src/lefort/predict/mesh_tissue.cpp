#include <lefort/geometry/bvh.h>
#include <lefort/mesh/generate_tets.h>
#include <lefort/predict/mesh_tissue.h>

#include <algorithm>

namespace lefort::predict {

Result<mesh::VolumeMesh> mesh_tissue(const TissueDomain& domain,
                                     const geometry::TriangleMesh& segment_L,
                                     const TissueOptions& options, Progress& progress) {
  const geometry::Bvh segment(segment_L);
  mesh::TetOptions tets;
  tets.element_size_mm = std::max(options.element_size_mm, options.far_element_size_mm);
  tets.size_at_mm = [&](const Vec3& p_L) {
    const auto nearest = segment.closest_point(p_L, options.margin_mm);
    const double share = nearest ? nearest->distance_mm / options.margin_mm : 1.0;
    return options.element_size_mm + share * (tets.element_size_mm - options.element_size_mm);
  };
  tets.surface_distance_mm = kSurfaceDistanceShare * options.element_size_mm;
  const auto level = [&domain](const Vec3& p_L) { return domain.level(p_L); };
  // The level ends at the box; a little beyond it is outside for certain.
  const Box3 box(domain.box_L.min() - Vec3::Ones(), domain.box_L.max() + Vec3::Ones());
  return mesh::generate_tets(level, box, tets, progress);
}

}  // namespace lefort::predict
