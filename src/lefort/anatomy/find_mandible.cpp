#include <lefort/anatomy/find_mandible.h>
#include <lefort/anatomy/seeded_watershed.h>

#include <array>
#include <cmath>
#include <vector>

namespace lefort::anatomy {
namespace {

// Lower limits; a child's mandible has 25 ml of bone, is 80 mm wide and 70 mm deep, but the scan
// may truncate it below.
constexpr double kMin_ml = 10.0;
constexpr double kMinWidth_mm = 50.0;
constexpr double kMinDepth_mm = 30.0;
// A mandible that is separated by markers has its rami: it is higher than any part of a maxilla
// that an erosion leaves.
constexpr double kMinHeight_mm = 45.0;
// Upper limit with teeth and metal; adults have 50 to 110 ml.
constexpr double kMax_ml = 150.0;
// Markers: bridges up to twice as thick as a radius are cut, after voxels below a multiple of the
// threshold of bone were removed. The first that leaves a mandible is used, so that it loses least.
constexpr std::array<double, 3> kDensities{1.0, 2.0, 3.0};
constexpr std::array<double, 4> kBridges_mm{1.0, 1.5, 2.0, 2.5};
// Bone deeper than this is marrow, and remains whatever its density.
constexpr double kMarrow_mm = 3.0;
// The chin lies in this frontal fraction of the length of the skull.
constexpr double kFront = 0.3;
// Largest distance of its middle from that of the skull, as a fraction of the width of the skull,
// about 150 mm. A clavicle or a shoulder lies further to the side.
constexpr double kMaxOffset = 0.15;

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

/// Whether a box lies as the mandible does: not wider than the skull, between its sides, as far to
/// the front, below its center, and up to it.
bool lies_as_mandible(const Box3& box, const Box3& skull) {
  const bool in_the_middle =
      std::abs(box.center().x() - skull.center().x()) < kMaxOffset * skull.sizes().x() &&
      box.sizes().x() < skull.sizes().x();
  const bool in_front = box.min().y() < skull.min().y() + kFront * skull.sizes().y();
  const bool below = box.center().z() < skull.center().z();
  const bool up_to_skull = box.max().z() > skull.min().z();
  return in_the_middle && in_front && below && up_to_skull;
}

/// The component that is the mandible; 0 if there is none.
std::int32_t jaw_among(const Components& parts, double min_height_mm) {
  const std::vector<Box3> boxes = boxes_of(parts);
  const std::int32_t skull = parts.largest();
  const Box3& head = boxes[std::size_t(skull)];
  const double ml = voxel_ml(parts.component_of.grid);
  std::int32_t jaw = 0;
  for (std::int32_t part = 1; part <= parts.count(); ++part) {
    const Box3& box = boxes[std::size_t(part)];
    const Vec3 size_mm = box.sizes();
    if (part == skull || double(parts.voxels[std::size_t(part)]) * ml < kMin_ml ||
        size_mm.x() < kMinWidth_mm || size_mm.y() < kMinDepth_mm || size_mm.z() < min_height_mm)
      continue;
    const bool larger =
        jaw == 0 || parts.voxels[std::size_t(part)] > parts.voxels[std::size_t(jaw)];
    if (lies_as_mandible(box, head) && larger) jaw = part;
  }
  return jaw;
}

Mask component(const Components& parts, std::int32_t part) {
  return mask_where(parts.component_of.grid,
                    [&](std::size_t v) { return parts.component_of.values[v] == part; });
}

bool is_plausible(const Mask& mandible) {
  const double ml = double(voxel_count(mandible)) * voxel_ml(mandible.grid);
  return ml >= kMin_ml && ml <= kMax_ml;
}

Mask none(const image::Grid& grid) {
  return mask_where(grid, [](std::size_t) { return false; });
}

/// The mandible among the basins of the cores of `dense`, a subset of `bone`; empty if there is
/// none.
Mask among_basins(const Mask& bone, const Mask& dense, double min_height_mm, double bridge_mm) {
  const image::ScalarVolume width_mm =
      distance_to(mask_where(bone.grid, [&](std::size_t v) { return dense.values[v] == 0; }));
  const Components cores = connected_components(
      mask_where(bone.grid, [&](std::size_t v) { return double(width_mm.values[v]) > bridge_mm; }),
      Neighbors::kFacesEdgesCorners);
  const std::int32_t core = cores.count() > 1 ? jaw_among(cores, min_height_mm) : 0;
  if (core == 0) return none(bone.grid);
  // The watershed separates mandible and skull at the narrowest cross-section of the bridge. Voxels
  // that are not dense are assigned last.
  // Other cores are no seeds, because they may be parts of the mandible that the erosion cut off.
  image::Volume<std::int32_t> seeds = cores.component_of;
  const std::int32_t skull = cores.largest();
  for (std::int32_t& seed : seeds.values)
    if (seed != core && seed != skull) seed = 0;
  const auto basins = seeded_watershed(seeds, bone, width_mm);
  const Mask basin = mask_where(bone.grid, [&](std::size_t v) { return basins.values[v] == core; });
  const Components parts = connected_components(basin, Neighbors::kFacesEdgesCorners);
  return component(parts, parts.largest());
}

}  // namespace

Mask find_mandible(const image::CtVolume& ct, const Mask& bone, double bone_hu) {
  const Components parts = connected_components(bone, Neighbors::kFacesEdgesCorners);
  if (parts.count() > 1)
    if (const std::int32_t jaw = jaw_among(parts, 0.0); jaw != 0)
      if (Mask mandible = component(parts, jaw); is_plausible(mandible)) return mandible;

  const image::ScalarVolume depth_mm =
      distance_to(mask_where(bone.grid, [&](std::size_t v) { return bone.values[v] == 0; }));
  for (const double density : kDensities) {
    // Of HU below zero a multiple would be no increase.
    const double min_hu = bone_hu + (density - 1.0) * std::abs(bone_hu);
    const Mask dense = mask_where(bone.grid, [&](std::size_t v) {
      return bone.values[v] != 0 && (density == 1.0 || double(ct.values[v]) >= min_hu ||
                                     double(depth_mm.values[v]) > kMarrow_mm);
    });
    for (const double bridge_mm : kBridges_mm) {
      const bool is_thin = density == 1.0 && bridge_mm == kBridges_mm.front();
      Mask mandible = among_basins(bone, dense, is_thin ? 0.0 : kMinHeight_mm, bridge_mm);
      if (is_plausible(mandible)) return mandible;
    }
  }
  return none(bone.grid);
}

}  // namespace lefort::anatomy
