#include <lefort/anatomy/pad_volume.h>
#include <lefort/anatomy/tissue_levels.h>
#include <lefort/anatomy/voxel_mask.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace lefort::anatomy {
namespace {

using image::ScalarVolume;

constexpr Index kPadding = 2;
// Levels made of labels end this far from their zero.
constexpr double kFar_mm = 3.0;
// Levels made of CT numbers end here at least, on both sides alike: the Gaussian then weighs
// voxels, not how dense they are, and neither cortical bone nor air pulls at a surface.
constexpr double kNear_mm = 0.8;
// The CT numbers of the plateaus beside a threshold.
constexpr double kPureAir_hu = -1000.0;
constexpr double kSoft_hu = 40.0;
// Typical slopes of CT numbers at a border, which turn HU into mm: soft tissue to cortical bone,
// and air to soft tissue, blurred over about 2 mm.
constexpr double kBoneSlope_hu_per_mm = 300.0;
constexpr double kSkinSlope_hu_per_mm = 450.0;
// Soft voxels this near to a sinus are its lining and the blur of its wall.
constexpr double kLining_mm = 1.6;
// A room in the solid with entrances up to twice as wide is filled.
constexpr double kLeak_mm = 2.0;
// Facial tissue this near to the outside is kept however thin it is.
constexpr double kSkinLayer_mm = 5.0;
// Sigma of the border the labels alone give, across foramina and defects.
constexpr double kLabelBorder_mm = 1.0;
// Sigmas that take the steps of voxels off a surface, whatever their size.
constexpr double kBoneSteps_voxels = 0.8;
constexpr double kSkinSteps_voxels = 1.0;
// CT numbers change over about this length at a border; the next voxel belongs to it at least.
constexpr double kLevelBlur_mm = 1.5;

/// `values` smoothed over `sigma_mm`, and over `steps_voxels` at least along each axis; not at all
/// if sigma_mm is 0.
ScalarVolume without_steps(const ScalarVolume& values, double sigma_mm, double steps_voxels) {
  if (sigma_mm == 0.0) return values;
  return smoothed(values, (steps_voxels * values.grid.spacing_mm).cwiseMax(sigma_mm));
}

/// Where a level made of CT numbers ends: at a voxel, so that partial volume is not cut to a step,
/// but no further than the nearer plateau allows, so that both sides end alike.
double level_end_mm(const image::Grid& grid, double to_plateau_hu, double slope_hu_per_mm) {
  return std::max(kNear_mm, std::min(grid.spacing_mm.maxCoeff(), to_plateau_hu / slope_hu_per_mm));
}

float clamped(double value_mm, double limit_mm) {
  return float(std::clamp(value_mm, -limit_mm, limit_mm));
}

/// Depth in a tissue of a voxel that does not belong to it: where its CT number says otherwise, it
/// is beside the tissue by half a voxel.
double outside_mm(const image::Grid& grid, double depth_mm) {
  return depth_mm < 0.0 ? depth_mm : -0.5 * grid.spacing_mm.minCoeff();
}

/// The scan and its labels on the wider grid: the scan goes on as at its faces, so that the cut
/// alone (within_scan) closes what it cuts off.
struct PaddedScan {
  image::CtVolume ct;
  LabelMap labels;
  LevelOptions options;

  [[nodiscard]] const image::Grid& grid() const { return ct.grid; }
  [[nodiscard]] Mask where(Tissue tissue) const {
    return mask_where(grid(), [&](std::size_t v) { return labels.values[v] == tissue; });
  }
};

template <class T>
image::Volume<T> continued(const image::Volume<T>& volume) {
  image::Volume<T> wide = padded(volume, margin_all_around(kPadding), T{});
  const auto inner = [](Index at, Index size) {
    return std::clamp(at, kPadding, size - 1 - kPadding);
  };
  const auto& size = wide.grid.size;
  for (Index k = 0; k < size[2]; ++k)
    for (Index j = 0; j < size[1]; ++j)
      for (Index i = 0; i < size[0]; ++i)
        wide.at(i, j, k) = wide.at(inner(i, size[0]), inner(j, size[1]), inner(k, size[2]));
  return wide;
}

PaddedScan padded_scan(const image::CtVolume& ct, const LabelMap& labels,
                       const LevelOptions& options) {
  LEFORT_CHECK(labels.grid == ct.grid);
  LEFORT_CHECK(ct.grid.voxel_count() > 0);
  LEFORT_CHECK(Index(ct.values.size()) == ct.grid.voxel_count());
  LEFORT_CHECK(labels.values.size() == ct.values.size());
  return {continued(ct), continued(labels), options};
}

template <class Value>
ScalarVolume volume_of(const image::Grid& grid, const Value& value) {
  ScalarVolume volume{grid, std::vector<float>(std::size_t(grid.voxel_count()))};
  parallel_for(
      grid.voxel_count(), [&](Index v) { volume.values[std::size_t(v)] = value(std::size_t(v)); },
      65536);
  return volume;
}

/// Distance to the border of a set, positive inside.
ScalarVolume signed_distance(const Mask& mask) {
  const ScalarVolume outside = distance_to(mask);
  const ScalarVolume inside =
      distance_to(mask_where(mask.grid, [&](std::size_t v) { return mask.values[v] == 0; }));
  // Between the centers of neighbors the distances leave a step of two halves: close it.
  const double half_mm = 0.5 * mask.grid.spacing_mm.minCoeff();
  return volume_of(mask.grid, [&](std::size_t v) {
    return clamped(mask.values[v] != 0 ? double(inside.values[v]) - half_mm
                                       : half_mm - double(outside.values[v]),
                   kFar_mm);
  });
}

/// Lowers `level` so that it is negative beyond the scan, zero half a voxel from its last voxels.
void cut_to_scan(ScalarVolume& level) {
  const auto& size = level.grid.size;
  const auto depth_mm = [&](Index at, std::size_t axis) {
    const double voxels = double(std::min(at, size[axis] - 1 - at)) - double(kPadding) + 0.5;
    return voxels * level.grid.spacing_mm[Index(axis)];
  };
  for (Index k = 0; k < size[2]; ++k)
    for (Index j = 0; j < size[1]; ++j)
      for (Index i = 0; i < size[0]; ++i) {
        const double depth = std::min({depth_mm(i, 0), depth_mm(j, 1), depth_mm(k, 2)});
        level.at(i, j, k) = std::min(level.at(i, j, k), clamped(depth, kFar_mm));
      }
}

/// Air in sinuses, their lining, and small soft rooms the solid encloses.
Mask sinus_filling(const PaddedScan& scan) {
  const Mask sinus = scan.where(Tissue::kSinus);
  const ScalarVolume to_sinus = distance_to(sinus);
  const Mask solid = mask_where(scan.grid(), [&](std::size_t v) {
    const Tissue tissue = scan.labels.values[v];
    const bool lining = is_soft_tissue(tissue) && double(to_sinus.values[v]) <= kLining_mm;
    return is_bone(tissue) || tissue == Tissue::kSinus || lining;
  });
  const Mask tight = closed(solid, kLeak_mm);
  const Parts rooms =
      connected_parts(mask_where(scan.grid(), [&](std::size_t v) { return tight.values[v] == 0; }),
                      Neighbors::kFaces);
  // A room that holds something else, or the largest one, which is the rest of the patient, stays.
  std::vector<std::uint8_t> stays = labels_touching(
      rooms, mask_where(scan.grid(),
                        [&](std::size_t v) { return !is_soft_tissue(scan.labels.values[v]); }));
  stays[std::size_t(rooms.largest())] = 1;
  return mask_where(scan.grid(), [&](std::size_t v) {
    const auto room = std::size_t(rooms.part_of.values[v]);
    const bool filled = room != 0 && stays[room] == 0;
    return (solid.values[v] != 0 || filled) && !is_bone(scan.labels.values[v]);
  });
}

ScalarVolume bone_level(const PaddedScan& scan, Cavities cavities) {
  const Mask filling = cavities == Cavities::kFillSinuses
                           ? sinus_filling(scan)
                           : mask_where(scan.grid(), [](std::size_t) { return false; });
  const double end_mm =
      level_end_mm(scan.grid(), scan.options.bone_hu - kSoft_hu, kBoneSlope_hu_per_mm);
  const ScalarVolume raw = volume_of(scan.grid(), [&](std::size_t v) {
    const double depth_mm =
        (double(scan.ct.values[v]) - scan.options.bone_hu) / kBoneSlope_hu_per_mm;
    if (filling.values[v] != 0) return float(end_mm);
    // Marrow is bone whatever its density, and what is dense but no bone is none.
    if (is_bone(scan.labels.values[v])) return clamped(depth_mm >= 0.0 ? depth_mm : end_mm, end_mm);
    return clamped(outside_mm(scan.grid(), depth_mm), end_mm);
  });
  return without_steps(raw, scan.options.bone_smoothing_mm, kBoneSteps_voxels);
}

/// Positive in what is not air; sinuses and airway are air too.
ScalarVolume flesh_level(const PaddedScan& scan) {
  const double end_mm = level_end_mm(
      scan.grid(), std::min(scan.options.skin_hu - kPureAir_hu, kSoft_hu - scan.options.skin_hu),
      kSkinSlope_hu_per_mm);
  const ScalarVolume raw = volume_of(scan.grid(), [&](std::size_t v) {
    const double depth_mm =
        (double(scan.ct.values[v]) - scan.options.skin_hu) / kSkinSlope_hu_per_mm;
    switch (scan.labels.values[v]) {
      case Tissue::kBackground:
      case Tissue::kAirway:
      case Tissue::kSinus:
        return clamped(outside_mm(scan.grid(), depth_mm), end_mm);
      default:
        return clamped(depth_mm, end_mm);
    }
  });
  return without_steps(raw, scan.options.skin_smoothing_mm, kSkinSteps_voxels);
}

/// Tells how much the parts but the largest hold.
void note_dropped(const Parts& parts, Progress& progress) {
  const Index all = std::accumulate(parts.voxels.begin() + 1, parts.voxels.end(), Index(0));
  const Index dropped = all - (parts.count() > 0 ? parts.voxels[std::size_t(parts.largest())] : 0);
  if (dropped == 0) return;
  progress.note(fmt::format(
      "{:.3g} ml of {:.3g} ml of soft tissue do not hang together with the rest and are left out",
      double(dropped) * voxel_ml(parts.part_of.grid), double(all) * voxel_ml(parts.part_of.grid)));
}

}  // namespace

ScalarVolume bone_level(const image::CtVolume& ct, const LabelMap& labels, Cavities cavities,
                        const LevelOptions& options) {
  ScalarVolume level = bone_level(padded_scan(ct, labels, options), cavities);
  cut_to_scan(level);
  return level;
}

ScalarVolume skin_level(const image::CtVolume& ct, const LabelMap& labels,
                        const LevelOptions& options) {
  const PaddedScan scan = padded_scan(ct, labels, options);
  const Mask by_background =
      dilated_by_one_voxel_or_more(scan.where(Tissue::kBackground), kLevelBlur_mm);
  const Mask by_air =
      dilated_by_one_voxel_or_more(mask_where(scan.grid(),
                                              [&](std::size_t v) {
                                                return scan.labels.values[v] == Tissue::kAirway ||
                                                       scan.labels.values[v] == Tissue::kSinus;
                                              }),
                                   kLevelBlur_mm);
  const ScalarVolume to_entrance = distance_to(mask_where(scan.grid(), [&](std::size_t v) {
    return scan.labels.values[v] == Tissue::kAirway && by_background.values[v] != 0;
  }));

  const ScalarVolume flesh = flesh_level(scan);
  ScalarVolume level = volume_of(scan.grid(), [&](std::size_t v) {
    // Air inside, and the blur of its walls, as far as it does not reach the skin.
    const bool inner = by_air.values[v] != 0 && by_background.values[v] == 0;
    const double depth_mm = double(to_entrance.values[v]) - scan.options.nostril_depth_mm;
    return inner ? std::max(flesh.values[v], clamped(depth_mm, kFar_mm)) : flesh.values[v];
  });
  cut_to_scan(level);
  return level;
}

ScalarVolume soft_tissue_level(const image::CtVolume& ct, const LabelMap& labels,
                               const LevelOptions& options, Progress& progress) {
  const PaddedScan scan = padded_scan(ct, labels, options);
  const image::Grid& grid = scan.grid();

  // Bone next to the brain counts as brain, so that no film is left on the inner table.
  const Mask by_brain = dilated_by_one_voxel_or_more(scan.where(Tissue::kBrain), kLevelBlur_mm);
  const Mask brain_and_table = mask_where(grid, [&](std::size_t v) {
    return scan.labels.values[v] == Tissue::kBrain ||
           (is_bone(scan.labels.values[v]) && by_brain.values[v] != 0);
  });
  const ScalarVolume brain =
      without_steps(signed_distance(brain_and_table), kLabelBorder_mm, kBoneSteps_voxels);
  const ScalarVolume bone = bone_level(scan, Cavities::kFillSinuses);
  const ScalarVolume flesh = flesh_level(scan);
  ScalarVolume level = volume_of(grid, [&](std::size_t v) {
    return std::min({flesh.values[v], -bone.values[v], -brain.values[v]});
  });

  // The skin over bone and the wings of the nose may be as thin as they are; sheets further inside
  // may not. One of n voxels is about n spacings thick: half a voxel lies beyond outer centers.
  const Mask inside = mask_where(grid, [&](std::size_t v) { return level.values[v] > 0.0F; });
  const double radius_mm = 0.5 * (options.thinnest_tissue_mm + grid.spacing_mm.minCoeff());
  const Mask thick = opened(inside, radius_mm);
  const ScalarVolume to_background = distance_to(scan.where(Tissue::kBackground));
  const Parts parts =
      connected_parts(mask_where(grid,
                                 [&](std::size_t v) {
                                   return thick.values[v] != 0 ||
                                          (inside.values[v] != 0 &&
                                           double(to_background.values[v]) <= kSkinLayer_mm);
                                 }),
                      Neighbors::kFaces);
  const std::int32_t largest = parts.largest();
  note_dropped(parts, progress);
  // The largest part, and around it as much as its surface may lie beyond its outer voxels.
  const Mask kept = dilated_by_one_voxel_or_more(
      mask_where(grid,
                 [&](std::size_t v) { return largest != 0 && parts.part_of.values[v] == largest; }),
      kLevelBlur_mm);
  const ScalarVolume room =
      without_steps(signed_distance(kept), kLabelBorder_mm, kBoneSteps_voxels);
  level = volume_of(grid, [&](std::size_t v) { return std::min(level.values[v], room.values[v]); });
  cut_to_scan(level);
  return level;
}

}  // namespace lefort::anatomy
