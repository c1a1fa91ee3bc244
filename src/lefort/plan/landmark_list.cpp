#include <lefort/geometry/mesh_properties.h>
#include <lefort/plan/internal/landmark_list.h>

#include <cmath>

namespace lefort::plan::internal {
namespace {

/// Area of the triangles that lie on a side of the box.
double area_on_side(const geometry::TriangleMesh& mesh, Index axis, double at_mm,
                    double tolerance_mm) {
  double area_mm2 = 0.0;
  for (Index t = 0; t < mesh.triangle_count(); ++t) {
    bool is_on = true;
    for (int c = 0; c < 3; ++c)
      is_on = is_on && std::abs(mesh.corner(t, c)[axis] - at_mm) <= tolerance_mm;
    if (is_on)
      area_mm2 += 0.5 * (mesh.corner(t, 1) - mesh.corner(t, 0))
                            .cross(mesh.corner(t, 2) - mesh.corner(t, 0))
                            .norm();
  }
  return area_mm2;
}

}  // namespace

bool ScanEnds::is_at_end(const Vec3& p_L, double margin_mm) const {
  for (Index axis = 0; axis < 3; ++axis) {
    const auto side = std::size_t(axis);
    if (is_low_cut[side] && p_L[axis] < box_L.min()[axis] + margin_mm) return true;
    if (is_high_cut[side] && p_L[axis] > box_L.max()[axis] - margin_mm) return true;
  }
  return false;
}

ScanEnds find_scan_ends(const HeadSurfaces& head) {
  // The tip of a nose with a radius of curvature of 12 mm has 75 mm2 within 1 mm of its top.
  constexpr double kMinArea_mm2 = 600.0;
  const geometry::TriangleMesh& widest = head.skin_L != nullptr ? *head.skin_L : *head.skull_L;
  ScanEnds ends{geometry::bounding_box(widest)};
  const double tolerance_mm = 0.5 * head.voxel_mm;
  for (Index axis = 0; axis < 3; ++axis) {
    const auto side = std::size_t(axis);
    ends.is_low_cut[side] =
        area_on_side(widest, axis, ends.box_L.min()[axis], tolerance_mm) > kMinArea_mm2;
    ends.is_high_cut[side] =
        area_on_side(widest, axis, ends.box_L.max()[axis], tolerance_mm) > kMinArea_mm2;
  }
  return ends;
}

void LandmarkList::add(const std::string& name, const std::optional<Extremum>& found_F,
                       double rule_mm, const std::string& reason) {
  constexpr double kMargin = 1.5;  // In voxels: smoothing rounds the edge where the scan ends.
  if (!found_F) return miss(name, reason);
  const Vec3 p_L = X_FL_.inverse() * found_F->point;
  if (ends_.is_at_end(p_L, kMargin * voxel_mm_)) return miss(name, "the scan ends there");
  found_.push_back({{name, p_L},
                    std::sqrt(found_F->spread_mm * found_F->spread_mm + rule_mm * rule_mm +
                              0.25 * voxel_mm_ * voxel_mm_)});
}

void LandmarkList::miss(const std::string& name, const std::string& reason) {
  missing_.push_back({name, reason});
}

std::optional<Vec3> LandmarkList::at(const std::string& name) const {
  for (const FoundLandmark& one : found_)
    if (one.landmark.name == name) return X_FL_ * one.landmark.point_L;
  return std::nullopt;
}

}  // namespace lefort::plan::internal
