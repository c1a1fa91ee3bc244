#include <lefort/anatomy/find_ct_table.h>
#include <lefort/anatomy/find_patient.h>
#include <lefort/anatomy/seeded_watershed.h>

namespace lefort::anatomy {
namespace {

// Objects are separated by removing everything thinner than twice this. Ears nevertheless remain
// part of the head: removed voxels go to the object they are connected with.
constexpr double kObjectBridge_mm = 2.0;
// Smaller pieces that this separates from the patient are part of the patient.
constexpr double kMinObject_ml = 8.0;
// Marrow is enclosed by cortical bone whose pores are narrower than twice this.
constexpr double kPore_mm = 1.1;
// Larger enclosed regions are a fluid-filled sinus or the cranial cavity.
constexpr double kMaxMarrow_ml = 3.0;

/// `bone`, and the small regions without air that `walls` encloses.
Mask with_marrow(const Mask& bone, const Mask& walls, const Mask& air) {
  const double ml = voxel_ml(bone.grid);
  const Components rooms = connected_components(
      mask_where(bone.grid, [&](std::size_t v) { return walls.values[v] == 0; }),
      Neighbors::kFaces);
  std::vector<std::uint8_t> is_marrow = components_overlapping(rooms, air);
  for (std::size_t room = 1; room < is_marrow.size(); ++room) {
    const bool small = double(rooms.voxels[room]) * ml <= kMaxMarrow_ml;
    is_marrow[room] = is_marrow[room] == 0 && small ? 1 : 0;
  }
  return mask_where(bone.grid, [&](std::size_t v) {
    return bone.values[v] != 0 || is_marrow[std::size_t(rooms.component_of.values[v])] != 0;
  });
}

}  // namespace

Mask find_patient(const image::CtVolume& ct, double skin_hu) {
  const Mask all =
      mask_where(ct.grid, [&](std::size_t v) { return double(ct.values[v]) >= skin_hu; });
  const Mask table = find_ct_table(all);
  const Mask dense = mask_where(
      ct.grid, [&](std::size_t v) { return all.values[v] != 0 && table.values[v] == 0; });
  const Mask thick = opened(dense, kObjectBridge_mm);
  const Components objects = connected_components(thick, Neighbors::kFaces);
  const std::int32_t patient = objects.largest();
  if (patient == 0) return thick;

  image::Volume<std::int32_t> seeds{ct.grid, std::vector<std::int32_t>(ct.values.size(), 0)};
  const double ml = voxel_ml(ct.grid);
  for (std::size_t v = 0; v < seeds.values.size(); ++v) {
    const std::int32_t object = objects.component_of.values[v];
    if (object == patient)
      seeds.values[v] = 1;
    else if (object != 0 && double(objects.voxels[std::size_t(object)]) * ml >= kMinObject_ml)
      seeds.values[v] = 2;
  }
  // The width is constant, so a voxel goes to the closer object.
  const image::ScalarVolume no_width{ct.grid, std::vector<float>(ct.values.size(), 0.0F)};
  const auto basins = seeded_watershed(seeds, dense, no_width);
  return mask_where(ct.grid, [&](std::size_t v) { return basins.values[v] == 1; });
}

Mask find_bone(const image::CtVolume& ct, const Mask& patient, const SegmentationOptions& options) {
  const Mask dense = mask_where(ct.grid, [&](std::size_t v) {
    return patient.values[v] != 0 && double(ct.values[v]) >= options.bone_hu;
  });
  const Components parts = connected_components(dense, Neighbors::kFacesEdgesCorners);
  std::vector<std::uint8_t> large(parts.voxels.size(), 0);
  for (std::size_t part = 1; part < large.size(); ++part)
    large[part] = double(parts.voxels[part]) * voxel_ml(ct.grid) >= options.min_bone_ml ? 1 : 0;
  const Mask bone = select_components(parts, large);

  const Mask air = mask_where(ct.grid, [&](std::size_t v) {
    return patient.values[v] == 0 || double(ct.values[v]) < options.skin_hu;
  });
  // The first pass closes pores; the second adds marrow that the closing had covered.
  const Mask filled = with_marrow(bone, closed(bone, kPore_mm), air);
  return with_marrow(filled, filled, air);
}

}  // namespace lefort::anatomy
