#include <lefort/anatomy/find_mandible.h>
#include <lefort/anatomy/seeded_watershed.h>

#include <vector>

namespace lefort::anatomy {
namespace {

// Lower limits; a child's mandible has 25 ml of bone, is 80 mm wide and 70 mm deep, but the scan
// may truncate it below.
constexpr double kMin_ml = 10.0;
constexpr double kMinWidth_mm = 50.0;
constexpr double kMinDepth_mm = 30.0;
// Bridges thinner than twice this between mandible and skull are touching surfaces.
constexpr double kBridge_mm = 1.0;
// The chin lies in this frontal fraction of the length of the skull.
constexpr double kFront = 0.3;

/// Bounding boxes of the components in L.
std::vector<Box3> boxes_of(const Components& parts) {
  std::vector<Box3> boxes(parts.voxels.size());
  const image::Grid& grid = parts.component_of.grid;
  for (Index k = 0; k < grid.size[2]; ++k)
    for (Index j = 0; j < grid.size[1]; ++j)
      for (Index i = 0; i < grid.size[0]; ++i)
        if (const std::int32_t part = parts.component_of.at(i, j, k); part != 0)
          boxes[std::size_t(part)].extend(grid.point_L({double(i), double(j), double(k)}));
  return boxes;
}

/// The component that is the mandible; 0 if there is none.
std::int32_t jaw_among(const Components& parts) {
  const std::vector<Box3> boxes = boxes_of(parts);
  const std::int32_t skull = parts.largest();
  const Box3& head = boxes[std::size_t(skull)];
  const double ml = voxel_ml(parts.component_of.grid);
  std::int32_t jaw = 0;
  for (std::int32_t part = 1; part <= parts.count(); ++part) {
    const Box3& box = boxes[std::size_t(part)];
    const Vec3 size_mm = box.sizes();
    if (part == skull || double(parts.voxels[std::size_t(part)]) * ml < kMin_ml ||
        size_mm.x() < kMinWidth_mm || size_mm.y() < kMinDepth_mm)
      continue;
    const bool in_front = box.min().y() < head.min().y() + kFront * head.sizes().y();
    const bool below = box.center().z() < head.center().z();
    const bool larger =
        jaw == 0 || parts.voxels[std::size_t(part)] > parts.voxels[std::size_t(jaw)];
    if (in_front && below && larger) jaw = part;
  }
  return jaw;
}

}  // namespace

Mask find_mandible(const Mask& bone) {
  const Components parts = connected_components(bone, Neighbors::kFacesEdgesCorners);
  if (parts.count() > 1)
    if (const std::int32_t jaw = jaw_among(parts); jaw != 0)
      return mask_where(bone.grid,
                        [&](std::size_t v) { return parts.component_of.values[v] == jaw; });

  const Components cores =
      connected_components(eroded(bone, kBridge_mm), Neighbors::kFacesEdgesCorners);
  const std::int32_t core = cores.count() > 1 ? jaw_among(cores) : 0;
  if (core == 0) return mask_where(bone.grid, [](std::size_t) { return false; });
  // The watershed separates mandible and skull at the narrowest cross-section of the bridge.
  const image::ScalarVolume width_mm =
      distance_to(mask_where(bone.grid, [&](std::size_t v) { return bone.values[v] == 0; }));
  const auto basins = seeded_watershed(cores.component_of, bone, width_mm);
  return mask_where(bone.grid, [&](std::size_t v) { return basins.values[v] == core; });
}

}  // namespace lefort::anatomy
