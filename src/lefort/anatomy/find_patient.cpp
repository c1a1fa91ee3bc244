#include <lefort/anatomy/find_ct_table.h>
#include <lefort/anatomy/find_patient.h>
#include <lefort/anatomy/seeded_watershed.h>

namespace lefort::anatomy {
namespace {

// Things are told apart after what is thinner than twice this is taken away. Ears stay with the
// head all the same: their voxels go to the thing they hang together with.
constexpr double kPatientBridge_mm = 2.0;
// What breaks off the patient that way and is smaller than this is part of the patient.
constexpr double kMinObject_ml = 8.0;
// Marrow lies behind cortical bone whose pores are narrower than twice this ...
constexpr double kPore_mm = 1.1;
// ... and a closed room larger than this is a sinus full of fluid, or the cranial cavity.
constexpr double kMaxMarrow_ml = 3.0;

/// `bone` and the small airless rooms that `walls` encloses.
Mask with_marrow(const Mask& bone, const Mask& walls, const Mask& air) {
  const double ml = voxel_ml(bone.grid);
  const Parts rooms =
      connected_parts(mask_where(bone.grid, [&](std::size_t v) { return walls.values[v] == 0; }),
                      Neighbors::kFaces);
  std::vector<std::uint8_t> is_marrow = labels_touching(rooms, air);
  for (std::size_t room = 1; room < is_marrow.size(); ++room) {
    const bool small = double(rooms.voxels[room]) * ml <= kMaxMarrow_ml;
    is_marrow[room] = is_marrow[room] == 0 && small ? 1 : 0;
  }
  return mask_where(bone.grid, [&](std::size_t v) {
    return bone.values[v] != 0 || is_marrow[std::size_t(rooms.part_of.values[v])] != 0;
  });
}

}  // namespace

Mask find_patient(const image::CtVolume& ct, double skin_hu) {
  const Mask all =
      mask_where(ct.grid, [&](std::size_t v) { return double(ct.values[v]) >= skin_hu; });
  const Mask table = find_ct_table(all);
  const Mask dense = mask_where(
      ct.grid, [&](std::size_t v) { return all.values[v] != 0 && table.values[v] == 0; });
  const Mask thick = opened(dense, kPatientBridge_mm);
  const Parts things = connected_parts(thick, Neighbors::kFaces);
  const std::int32_t patient = things.largest();
  if (patient == 0) return thick;

  image::Volume<std::int32_t> seeds{ct.grid, std::vector<std::int32_t>(ct.values.size(), 0)};
  const double ml = voxel_ml(ct.grid);
  for (std::size_t v = 0; v < seeds.values.size(); ++v) {
    const std::int32_t thing = things.part_of.values[v];
    if (thing == patient)
      seeds.values[v] = 1;
    else if (thing != 0 && double(things.voxels[std::size_t(thing)]) * ml >= kMinObject_ml)
      seeds.values[v] = 2;
  }
  // All bridges are alike: the nearer thing takes a voxel.
  const image::ScalarVolume no_width{ct.grid, std::vector<float>(ct.values.size(), 0.0F)};
  const auto taken_by = seeded_watershed(seeds, dense, no_width);
  return mask_where(ct.grid, [&](std::size_t v) { return taken_by.values[v] == 1; });
}

Mask find_bone(const image::CtVolume& ct, const Mask& patient, const SegmentationOptions& options) {
  const Mask dense = mask_where(ct.grid, [&](std::size_t v) {
    return patient.values[v] != 0 && double(ct.values[v]) >= options.bone_hu;
  });
  const Parts parts = connected_parts(dense, Neighbors::kFacesEdgesCorners);
  std::vector<std::uint8_t> large(parts.voxels.size(), 0);
  for (std::size_t part = 1; part < large.size(); ++part)
    large[part] = double(parts.voxels[part]) * voxel_ml(ct.grid) >= options.min_bone_ml ? 1 : 0;
  const Mask bone = select_labels(parts, large);

  const Mask air = mask_where(ct.grid, [&](std::size_t v) {
    return patient.values[v] == 0 || double(ct.values[v]) < options.skin_hu;
  });
  // First with pores shut; then what the pores' lids had covered.
  const Mask filled = with_marrow(bone, closed(bone, kPore_mm), air);
  return with_marrow(filled, filled, air);
}

}  // namespace lefort::anatomy
