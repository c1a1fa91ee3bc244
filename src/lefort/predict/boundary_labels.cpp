#include <lefort/image/visit_voxels_near.h>
#include <lefort/predict/boundary_labels.h>

namespace lefort::predict {

double max_paint_distance_mm(const image::Grid& grid) { return 0.5 * grid.spacing_mm.norm(); }

BoundaryLabel painted_at(const BoundaryLabelMap& painted, const Vec3& p_L) {
  constexpr double kRoundOff = 1.0 + 1e-9;  // Includes the corners of the voxel.
  const image::Grid& grid = painted.grid;
  double nearest_mm = kRoundOff * max_paint_distance_mm(grid);
  BoundaryLabel label = BoundaryLabel::kNone;
  image::visit_voxels_near(grid, p_L, nearest_mm, [&](Index i, Index j, Index k) {
    const BoundaryLabel here = painted.at(i, j, k);
    if (here == BoundaryLabel::kNone) return;
    const double distance_mm = (grid.point_L(Vec3(double(i), double(j), double(k))) - p_L).norm();
    if (distance_mm > nearest_mm) return;
    if (distance_mm == nearest_mm && label != BoundaryLabel::kNone) return;
    nearest_mm = distance_mm;
    label = here;
  });
  return label;
}

}  // namespace lefort::predict
