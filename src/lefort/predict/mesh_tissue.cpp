#include <lefort/core/check.h>
#include <lefort/geometry/bvh.h>
#include <lefort/mesh/boundary_layer.h>
#include <lefort/mesh/element_quality.h>
#include <lefort/mesh/generate_tets.h>
#include <lefort/predict/mesh_tissue.h>
#include <lefort/predict/skin_faces.h>

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

namespace lefort::predict {

namespace {

/// Stricter than kMinJacobian, because the boundary layer compresses the elements below it.
constexpr double kJacobianBeforeSkin = 0.12;

/// Center of the most anterior tissue voxel, the tip of the nose: L's y axis points to posterior.
Vec3 nose_tip(const TissueDomain& domain) {
  const image::ScalarVolume& level = domain.soft_tissue_level;
  Vec3 found_L = Vec3::Zero();
  double min_y_mm = std::numeric_limits<double>::max();
  for (Index k = 0; k < level.grid.size[2]; ++k)
    for (Index j = 0; j < level.grid.size[1]; ++j)
      for (Index i = 0; i < level.grid.size[0]; ++i) {
        if (!(level.at(i, j, k) > 0.0F)) continue;
        const Vec3 p_L = level.grid.point_L({double(i), double(j), double(k)});
        if (!(p_L.y() < min_y_mm) || !domain.box_L.contains(p_L)) continue;
        min_y_mm = p_L.y();
        found_L = p_L;
      }
  return found_L;
}

Result<mesh::VolumeMesh> fill(const TissueDomain& domain, const geometry::TriangleMesh& segment_L,
                              const TissueOptions& options, double min_scaled_jacobian,
                              Progress& progress) {
  const geometry::Bvh segment(segment_L);
  mesh::TetOptions tets;
  tets.element_size_mm = std::max(options.element_size_mm, options.far_element_size_mm);
  std::vector<Vec3> face_points_L;
  if (options.face) face_points_L = options.face->points_L;
  if (options.face && face_points_L.empty()) face_points_L.push_back(nose_tip(domain));
  // Linear from the finest size to that at the border of the region, over the margin.
  const auto size_mm = [&](double finest_mm, double distance_mm) {
    const double fraction = std::min(1.0, distance_mm / options.margin_mm);
    return finest_mm + fraction * (tets.element_size_mm - finest_mm);
  };
  tets.size_at_mm = [&](const Vec3& p_L) {
    const auto nearest = segment.closest_point(p_L, options.margin_mm);
    double wanted_mm =
        size_mm(options.element_size_mm, nearest ? nearest->distance_mm : options.margin_mm);
    for (const Vec3& point_L : face_points_L)
      wanted_mm =
          std::min(wanted_mm, size_mm(options.face->element_size_mm, (p_L - point_L).norm()));
    return wanted_mm;
  };
  tets.min_scaled_jacobian = min_scaled_jacobian;
  const double finest_mm = options.face
                               ? std::min(options.element_size_mm, options.face->element_size_mm)
                               : options.element_size_mm;
  tets.surface_distance_mm = kSurfaceDistanceFraction * finest_mm;
  const auto level = [&domain](const Vec3& p_L) { return domain.level(p_L); };
  // The level is negative outside the box; 1 mm beyond it is certainly outside.
  const Box3 box(domain.box_L.min() - Vec3::Ones(), domain.box_L.max() + Vec3::Ones());
  return mesh::generate_tets(level, box, tets, progress);
}

}  // namespace

Result<mesh::VolumeMesh> mesh_tissue(const TissueDomain& domain,
                                     const geometry::TriangleMesh& segment_L,
                                     const TissueOptions& options, Progress& progress) {
  LEFORT_CHECK(!options.skin);
  return fill(domain, segment_L, options, 0.0, progress);
}

Result<mesh::VolumeMesh> mesh_tissue_and_skin(const TissueDomain& domain,
                                              const geometry::TriangleMesh& skin_L,
                                              const geometry::TriangleMesh& segment_L,
                                              const geometry::TriangleMesh& remainder_L,
                                              const TissueOptions& options, double contact_snap_mm,
                                              Progress& progress) {
  LEFORT_CHECK(options.skin);
  LEFORT_TRY(const mesh::VolumeMesh tets,
             fill(domain, segment_L, options, kJacobianBeforeSkin, progress));
  const std::vector<mesh::Face> faces =
      skin_faces(tets, domain, skin_L, segment_L, remainder_L, contact_snap_mm);
  if (faces.empty())
    return fail(ErrorCode::kAnatomyMissing, "no skin bounds the tissue around the segment");
  std::vector<mesh::HalfSpace> cut_planes = domain.cuts_L;
  cut_planes.insert(cut_planes.end(), domain.scan_boundaries_L.begin(),
                    domain.scan_boundaries_L.end());
  LEFORT_TRY(mesh::VolumeMesh mixed,
             mesh::add_boundary_layer(tets, faces, cut_planes,
                                      {.thickness_mm = options.skin->thickness_mm,
                                       .layers = options.skin->layers,
                                       .region = regions::kSkin},
                                      progress));
  if (const auto poor = mesh::poor_elements(mixed, kMinJacobian); !poor.empty()) {
    const mesh::PoorElement& worst = *std::min_element(
        poor.begin(), poor.end(), [](const mesh::PoorElement& a, const mesh::PoorElement& b) {
          return a.scaled_jacobian < b.scaled_jacobian;
        });
    return fail(
        ErrorCode::kMeshingFailed,
        fmt::format("{} of {} elements have a scaled Jacobian below {}, minimum {:.3f} (a {} "
                    "at ({:.1f}, {:.1f}, {:.1f}) mm): use another tissue.element_size_mm",
                    poor.size(), mixed.element_count(), kMinJacobian, worst.scaled_jacobian,
                    mesh::name_of(worst.shape), worst.center_L.x(), worst.center_L.y(),
                    worst.center_L.z()));
  }
  return mixed;
}

}  // namespace lefort::predict
