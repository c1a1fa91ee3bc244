#include <lefort/image/interpolate.h>
#include <lefort/predict/tissue_domain.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

namespace lefort::predict {
namespace {

constexpr double kOutside_mm = -4.0;  // Smallest value of a level.

/// Distance of a point from the border of the common part of all half-spaces; negative outside.
double depth_inside(std::span<const mesh::HalfSpace> half_spaces, const Vec3& p) {
  double depth = std::numeric_limits<double>::infinity();
  for (const mesh::HalfSpace& half_space : half_spaces)
    depth = std::min(depth, half_space.normal.dot(p - half_space.point));
  return depth;
}

std::vector<mesh::HalfSpace> sides_of_box(const Box3& box) {
  std::vector<mesh::HalfSpace> sides;
  for (int axis = 0; axis < 3; ++axis) {
    sides.push_back({box.min(), Vec3::Unit(axis)});
    sides.push_back({box.max(), -Vec3::Unit(axis)});
  }
  return sides;
}

std::vector<mesh::HalfSpace> sides_of_scan(const image::Grid& grid) {
  std::vector<mesh::HalfSpace> sides;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 low_V = kScanBoundaryInset_voxels * Vec3::Ones();
    Vec3 high_V = -low_V;
    for (int a = 0; a < 3; ++a) high_V[a] += double(grid.size[std::size_t(a)] - 1);
    sides.push_back({grid.point_L(low_V), grid.direction.col(axis)});
    sides.push_back({grid.point_L(high_V), -grid.direction.col(axis)});
  }
  return sides;
}

}  // namespace

double TissueDomain::level(const Vec3& p_L) const {
  const double tissue = image::interpolate(soft_tissue_level, p_L, kOutside_mm);
  return std::min({tissue, depth_inside(cuts_L, p_L), depth_inside(scan_boundaries_L, p_L)});
}

double TissueDomain::distance_to_cut(const Vec3& p_L) const {
  return std::abs(depth_inside(cuts_L, p_L));
}

double TissueDomain::distance_to_scan_boundary(const Vec3& p_L) const {
  return std::abs(depth_inside(scan_boundaries_L, p_L));
}

std::vector<Vec3> TissueDomain::planes_at(const Vec3& p_L, double tolerance_mm) const {
  std::vector<Vec3> normals;
  for (const auto* planes : {&cuts_L, &scan_boundaries_L})
    for (const mesh::HalfSpace& plane : *planes)
      if (std::abs(plane.normal.dot(p_L - plane.point)) <= tolerance_mm)
        normals.push_back(plane.normal);
  return normals;
}

TissueDomain make_tissue_domain(image::ScalarVolume soft_tissue_level, const image::Grid& scan_grid,
                                const geometry::TriangleMesh& segment_L,
                                const TissueOptions& options) {
  Box3 box;
  for (const Vec3& vertex : segment_L.vertices) box.extend(vertex);
  const Vec3 margin = Vec3::Constant(options.margin_mm);
  box.min() -= margin;
  box.max() += margin;
  return {std::move(soft_tissue_level), box, sides_of_box(box), sides_of_scan(scan_grid)};
}

}  // namespace lefort::predict
