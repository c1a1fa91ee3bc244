#include <lefort/anatomy/find_occlusal_planes.h>
#include <lefort/anatomy/find_teeth.h>
#include <lefort/anatomy/pad_volume.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace lefort::anatomy {
namespace {

// CT numbers: enamel has more than 2000 HU, dentin about 1500, the cortical bone of jaws 800 to
// 1500; voxels average them.
constexpr double kCrown_hu = 1700.0;
constexpr double kDentin_hu = 1200.0;
// The border of a tooth with soft tissue: between half of dentin and half of enamel.
constexpr double kToothBorder_hu = 1000.0;
// There are only crowns so close to the occlusal plane; roots end so far from it.
constexpr double kCrown_mm = 6.0;
constexpr double kRoot_mm = 24.0;
// The least enamel of a crown.
constexpr double kMinCrownEnamel_mm3 = 5.0;
// Roots may be inclined.
constexpr double kInclination_mm = 1.5;
// Half the thickness of a root, at least; cortical bone within the footprint is thinner.
constexpr double kRootRadius_mm = 0.8;
// Width of the blurred border of a crown.
constexpr double kCrownBorder_mm = 1.2;
constexpr double kFootprintCell_mm = 0.5;
// Wide arches, and the roots of third molars.
constexpr double kArchMargin_mm = 6.0;

/// Whether both jaws lie on their sides of the plane.
bool divides_jaws(const OcclusalPlane& plane, const LabelMap& labels) {
  constexpr double kMinFraction = 0.8;
  double right = 0.0, all = 0.0;
  const auto& size = labels.grid.size;
  for (Index k = 0; k < size[2]; ++k)
    for (Index j = 0; j < size[1]; ++j)
      for (Index i = 0; i < size[0]; ++i) {
        const Tissue tissue = labels.at(i, j, k);
        if (!is_bone(tissue)) continue;
        const Vec3 p_L = labels.grid.point_L({double(i), double(j), double(k)});
        const double height_mm = plane.height_mm(p_L);
        if (!plane.is_in_arch_column(p_L) || std::abs(height_mm) > kRoot_mm) continue;
        all += 1.0;
        if ((tissue == Tissue::kMandible) == (height_mm < 0.0)) right += 1.0;
      }
  return all > 0.0 && right >= kMinFraction * all;
}

std::optional<OcclusalPlane> plane_between_jaws(const image::CtVolume& ct, const LabelMap& labels,
                                                double bone_hu) {
  const Mask bone =
      mask_where(labels.grid, [&](std::size_t v) { return is_bone(labels.values[v]); });
  for (const OcclusalPlane& plane : find_occlusal_planes(ct, bone, bone_hu))
    if (plane.is_of_enamel && divides_jaws(plane, labels)) return plane;
  return std::nullopt;
}

/// Cells of the plane below and above which a jaw has crowns.
class Footprint {
 public:
  explicit Footprint(const OcclusalPlane& plane) : normal_L_(plane.normal_L) {
    first_L_ = normal_L_.cross(Vec3::UnitY()).normalized();
    second_L_ = normal_L_.cross(first_L_);
  }
  /// Adds all cells within kInclination_mm of a point.
  void add(const Vec3& p_L) {
    const auto [a, b] = cell(p_L);
    constexpr int kReach = int(kInclination_mm / kFootprintCell_mm);
    for (int y = -kReach; y <= kReach; ++y)
      for (int x = -kReach; x <= kReach; ++x)
        if (x * x + y * y <= kReach * kReach) cells_[{a + x, b + y}] = true;
  }
  [[nodiscard]] bool contains(const Vec3& p_L) const { return cells_.contains(cell(p_L)); }

 private:
  [[nodiscard]] std::pair<int, int> cell(const Vec3& p_L) const {
    return {int(std::floor(first_L_.dot(p_L) / kFootprintCell_mm)),
            int(std::floor(second_L_.dot(p_L) / kFootprintCell_mm))};
  }
  Vec3 normal_L_, first_L_, second_L_;
  std::map<std::pair<int, int>, bool> cells_;
};

/// A jaw in the box around the dental arches.
struct JawBox {
  const image::CtVolume& ct;
  const Mask& jaw;  ///< Its bone with teeth.
  const OcclusalPlane& plane;

  [[nodiscard]] Vec3 point_L(std::size_t v) const {
    const image::Grid& grid = jaw.grid;
    const Index i = Index(v) % grid.size[0], jk = Index(v) / grid.size[0];
    const Index j = jk % grid.size[1], k = jk / grid.size[1];
    return grid.point_L({double(i), double(j), double(k)});
  }
  [[nodiscard]] bool is_near_plane(std::size_t v, double limit_mm) const {
    return std::abs(plane.height_mm(point_L(v))) < limit_mm;
  }
};

/// The crowns: what is denser than the border of a tooth close to the plane, and connected with
/// enamel or metal.
Mask crowns_of(const JawBox& box) {
  const Components parts = connected_components(
      mask_where(box.jaw.grid,
                 [&](std::size_t v) {
                   return box.jaw.values[v] != 0 && double(box.ct.values[v]) >= kToothBorder_hu &&
                          box.is_near_plane(v, kCrown_mm);
                 }),
      Neighbors::kFaces);
  std::vector<double> enamel_mm3(parts.voxels.size(), 0.0);
  for (std::size_t v = 0; v < box.jaw.values.size(); ++v)
    if (double(box.ct.values[v]) >= kCrown_hu)
      enamel_mm3[std::size_t(parts.component_of.values[v])] += voxel_ml(box.jaw.grid) * 1e3;
  std::vector<std::uint8_t> is_crown(parts.voxels.size(), 0);
  for (std::size_t part = 1; part < parts.voxels.size(); ++part)
    is_crown[part] = enamel_mm3[part] >= kMinCrownEnamel_mm3 ? 1 : 0;
  return select_components(parts, is_crown);
}

/// Crowns with their roots.
Mask teeth_of(const JawBox& box) {
  const Mask crowns = crowns_of(box);
  Footprint footprint(box.plane);
  for (std::size_t v = 0; v < crowns.values.size(); ++v)
    if (crowns.values[v] != 0) footprint.add(box.point_L(v));
  const Mask dense = mask_where(box.jaw.grid, [&](std::size_t v) {
    return box.jaw.values[v] != 0 && double(box.ct.values[v]) >= kDentin_hu &&
           box.is_near_plane(v, kRoot_mm) && footprint.contains(box.point_L(v));
  });
  const Mask thick = opened(dense, kRootRadius_mm);
  const Components parts = connected_components(
      mask_where(dense.grid,
                 [&](std::size_t v) {
                   return (thick.values[v] != 0 && dense.values[v] != 0) || crowns.values[v] != 0;
                 }),
      Neighbors::kFaces);
  const Mask cores = select_components(parts, components_overlapping(parts, crowns));
  // The blurred border of a tooth: close to it, and no thicker bone.
  const Mask rest = mask_where(
      dense.grid, [&](std::size_t v) { return box.jaw.values[v] != 0 && cores.values[v] == 0; });
  const Mask thick_rest = opened(rest, kCrownBorder_mm);
  const image::ScalarVolume to_core = distance_to(cores);
  return mask_where(dense.grid, [&](std::size_t v) {
    if (cores.values[v] != 0) return true;
    return rest.values[v] != 0 && thick_rest.values[v] == 0 &&
           double(box.ct.values[v]) >= kToothBorder_hu &&
           double(to_core.values[v]) <= kCrownBorder_mm;
  });
}

}  // namespace

ToothMap find_teeth(const image::CtVolume& ct, const LabelMap& labels, double bone_hu) {
  ToothMap teeth{labels.grid, std::vector<Tooth>(labels.values.size(), Tooth::kNone)};
  if (std::find(labels.values.begin(), labels.values.end(), Tissue::kMandible) ==
      labels.values.end())
    return teeth;
  const auto plane = plane_between_jaws(ct, labels, bone_hu);
  if (!plane) return teeth;
  const image::Grid& grid = labels.grid;
  const Margin margin = margin_around(grid, {2, 2, 2}, [&](std::size_t v) {
    if (!is_bone(labels.values[v])) return false;
    const Index i = Index(v) % grid.size[0], jk = Index(v) / grid.size[0];
    const Index j = jk % grid.size[1], k = jk / grid.size[1];
    const Vec3 p_L = grid.point_L({double(i), double(j), double(k)});
    return plane->is_in_arch_column(p_L, kArchMargin_mm) &&
           std::abs(plane->height_mm(p_L)) < kRoot_mm;
  });
  const image::CtVolume near_ct = cropped(ct, margin);
  const LabelMap near = cropped(labels, margin);
  ToothMap found = cropped(teeth, margin);
  for (const auto& [tissue, tooth] :
       {std::pair(Tissue::kBone, Tooth::kUpper), std::pair(Tissue::kMandible, Tooth::kLower)}) {
    const Mask jaw =
        mask_where(near.grid, [&, t = tissue](std::size_t v) { return near.values[v] == t; });
    const Mask one = teeth_of({near_ct, jaw, *plane});
    for (std::size_t v = 0; v < one.values.size(); ++v)
      if (one.values[v] != 0) found.values[v] = tooth;
  }
  paste(found, margin, teeth);
  return teeth;
}

}  // namespace lefort::anatomy
