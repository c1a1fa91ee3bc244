#include <lefort/predict/jaw_edges.h>
#include <lefort/predict/oral_vestibule.h>

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

namespace lefort::predict {
namespace {

using anatomy::Tissue;

/// The dental arches: half their width, and their depth up to the anterior border of the ramus.
constexpr double kArchHalfWidth_mm = 35.0, kArchDepth_mm = 45.0;
/// Teeth may reach this far beyond the edge of the incisors: canines, a curved occlusal plane.
constexpr double kBeyondEdge_mm = 8.0;
/// Bone this far from the level of the edges is none of the facing edges.
constexpr double kNearEdges_mm = 15.0;
/// Facing edges further than this from the plane are left out, in this order.
constexpr std::array<double, 4> kLimits_mm{15.0, 8.0, 5.0, 4.0};
constexpr std::size_t kMinColumns = 50;  ///< With fewer, the plane is horizontal.
constexpr double kMinUpright = 0.82;     ///< cos 35 degrees, as find_occlusal_planes().

/// The facing edges of both jaws in a column of 1 mm2.
struct FacingEdges {
  double upper_z_mm = 0.0, lower_z_mm = 0.0;
  bool has_upper = false, has_lower = false;
};

/// Midpoints of the facing edges, relative to the middle of the edges at the incisors.
std::vector<Vec3> midpoints_of_edges(const anatomy::LabelMap& labels, const Vec3& front_L) {
  std::map<std::pair<Index, Index>, FacingEdges> columns;
  const auto& size = labels.grid.size;
  for (Index k = 0; k < size[2]; ++k)
    for (Index j = 0; j < size[1]; ++j)
      for (Index i = 0; i < size[0]; ++i) {
        const Tissue tissue = labels.at(i, j, k);
        if (!anatomy::is_bone(tissue)) continue;
        const Vec3 d = labels.grid.point_L({double(i), double(j), double(k)}) - front_L;
        if (std::abs(d.x()) > kArchHalfWidth_mm || d.y() > kArchDepth_mm ||
            std::abs(d.z()) > kNearEdges_mm)
          continue;
        FacingEdges& edges = columns[{std::lround(d.x()), std::lround(d.y())}];
        if (tissue == Tissue::kMandible) {
          edges.lower_z_mm = edges.has_lower ? std::max(edges.lower_z_mm, d.z()) : d.z();
          edges.has_lower = true;
        } else {
          edges.upper_z_mm = edges.has_upper ? std::min(edges.upper_z_mm, d.z()) : d.z();
          edges.has_upper = true;
        }
      }
  std::vector<Vec3> midpoints;
  for (const auto& [column, edges] : columns)
    if (edges.has_upper && edges.has_lower)
      midpoints.emplace_back(double(column.first), double(column.second),
                             0.5 * (edges.upper_z_mm + edges.lower_z_mm));
  return midpoints;
}

/// Normal of the least-squares plane z = a + b x + c y, after points far from it are left out.
Vec3 normal_of(const std::vector<Vec3>& points) {
  Vec3 fit = Vec3::Zero();
  for (const double limit_mm : kLimits_mm) {
    Mat3 matrix = Mat3::Zero();
    Vec3 right = Vec3::Zero();
    std::size_t count = 0;
    for (const Vec3& p : points) {
      const Vec3 row(1.0, p.x(), p.y());
      if (std::abs(fit.dot(row) - p.z()) > limit_mm) continue;
      matrix += row * row.transpose();
      right += p.z() * row;
      ++count;
    }
    if (count < kMinColumns) return Vec3::UnitZ();
    fit = matrix.ldlt().solve(right);
  }
  const Vec3 normal = Vec3(-fit[1], -fit[2], 1.0).normalized();
  return normal.z() > kMinUpright ? normal : Vec3::UnitZ();
}

}  // namespace

bool OralVestibule::contains(const Vec3& p_L, bool on_mandible) const {
  if (const JawTooth* tooth = teeth ? teeth->tooth_at(p_L, on_mandible) : nullptr) {
    // To inferior of the border of a lower tooth lies its root.
    const double sign = on_mandible ? -1.0 : 1.0;
    const double beyond_border_mm = sign * normal_L.dot(p_L - tooth->border_L);
    const double beyond_tip_mm = -sign * normal_L.dot(p_L - tooth->tip_L);
    return beyond_border_mm < depth_mm && beyond_tip_mm < kBeyondEdge_mm;
  }
  if (std::abs(p_L.x() - front_L.x()) > kArchHalfWidth_mm || p_L.y() > front_L.y() + kArchDepth_mm)
    return false;
  const double height_mm = normal_L.dot(p_L);
  return on_mandible ? height_mm > lower_fold_mm && height_mm < lower_edge_mm + kBeyondEdge_mm
                     : height_mm < upper_fold_mm && height_mm > upper_edge_mm - kBeyondEdge_mm;
}

std::optional<OralVestibule> find_oral_vestibule(const anatomy::LabelMap& labels, double depth_mm,
                                                 const JawTeeth* teeth) {
  const std::optional<JawEdges> edges = find_jaw_edges(labels, teeth);
  if (!edges) return std::nullopt;
  const std::vector<double> front_y_mm =
      anterior_surface_y_mm(labels, edges->middle_x_mm, 1,
                            {std::min(edges->upper_z_mm, edges->lower_z_mm),
                             std::max(edges->upper_z_mm, edges->lower_z_mm)},
                            teeth);
  if (front_y_mm.empty()) return std::nullopt;
  OralVestibule vestibule;
  vestibule.depth_mm = depth_mm;
  vestibule.teeth = teeth;
  vestibule.front_L = {edges->middle_x_mm, front_y_mm.front(), edges->middle_z_mm()};
  vestibule.normal_L = normal_of(midpoints_of_edges(labels, vestibule.front_L));
  const auto height_mm = [&](double z_mm) {
    return vestibule.normal_L.dot(Vec3(vestibule.front_L.x(), vestibule.front_L.y(), z_mm));
  };
  vestibule.upper_edge_mm = height_mm(edges->upper_z_mm);
  vestibule.lower_edge_mm = height_mm(edges->lower_z_mm);
  vestibule.upper_fold_mm = vestibule.upper_edge_mm + kUpperCrown_mm + depth_mm;
  vestibule.lower_fold_mm = vestibule.lower_edge_mm - kLowerCrown_mm - depth_mm;
  return vestibule;
}

}  // namespace lefort::predict
