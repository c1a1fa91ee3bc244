#include <lefort/anatomy/pad_volume.h>
#include <lefort/anatomy/separate_levels.h>
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
// Level-set functions computed from labels are clamped to this magnitude.
constexpr double kLabelClamp_mm = 3.0;
// Those computed from CT numbers are clamped to at least this magnitude, equally on both sides:
// then the Gaussian weighs voxels independently of their density, and neither cortical bone nor air
// shifts a surface.
constexpr double kMinClamp_mm = 0.8;
// CT numbers of the plateaus on both sides of a threshold.
constexpr double kPureAir_hu = -1000.0;
constexpr double kSoft_hu = 40.0;
// Typical gradients of CT numbers at a border, which convert HU to mm: soft tissue to cortical
// bone, and air to soft tissue, blurred over about 2 mm.
constexpr double kBoneSlope_hu_per_mm = 300.0;
constexpr double kSkinSlope_hu_per_mm = 450.0;
// Soft voxels this close to a sinus are its mucosa and the blur of its wall.
constexpr double kLining_mm = 1.6;
// Regions enclosed by bone and sinuses are filled if their entrances are at most twice as wide.
constexpr double kEntrance_mm = 2.0;
// Facial tissue this close to the outside is kept even if it is thin.
constexpr double kSkinLayer_mm = 5.0;
// Sigma for borders that depend on labels only, across foramina and defects.
constexpr double kLabelBorder_mm = 1.0;
// Sigmas that remove voxel steps from a surface, in voxels.
constexpr double kBoneSteps_voxels = 0.8;
constexpr double kSkinSteps_voxels = 1.0;
// Width of the blur of CT numbers at a border; at least the next voxel belongs to it.
constexpr double kLevelBlur_mm = 1.5;

/// `values` smoothed over `sigma_mm`, and at least over `steps_voxels` along each axis; unchanged
/// if sigma_mm is 0.
ScalarVolume without_voxel_steps(const ScalarVolume& values, double sigma_mm, double steps_voxels) {
  if (sigma_mm == 0.0) return values;
  return smoothed(values, (steps_voxels * values.grid.spacing_mm).cwiseMax(sigma_mm));
}

/// Magnitude at which a level-set function computed from CT numbers is clamped: one voxel, so that
/// partial volume is not reduced to a step, but not more than the closer plateau allows, so that
/// both sides are clamped equally.
double clamp_limit_mm(const image::Grid& grid, double to_plateau_hu, double slope_hu_per_mm) {
  return std::max(kMinClamp_mm,
                  std::min(grid.spacing_mm.maxCoeff(), to_plateau_hu / slope_hu_per_mm));
}

float clamped(double value_mm, double limit_mm) {
  return float(std::clamp(value_mm, -limit_mm, limit_mm));
}

/// Level of a voxel that does not belong to a tissue: if its CT number says otherwise, it is half a
/// voxel outside.
double outside_mm(const image::Grid& grid, double depth_mm) {
  return depth_mm < 0.0 ? depth_mm : -0.5 * grid.spacing_mm.minCoeff();
}

/// The scan and its labels on the padded grid. The padding repeats the values at the faces, so that
/// only cut_to_scan() closes what the scan truncates.
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
image::Volume<T> extended(const image::Volume<T>& volume) {
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
  return {extended(ct), extended(labels), options};
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
  // Distances are measured from voxel centers; subtracting half a voxel makes them continuous.
  const double half_mm = 0.5 * mask.grid.spacing_mm.minCoeff();
  const double max_mm = kLabelClamp_mm + half_mm;  // Larger distances are clamped.
  const ScalarVolume outside = distance_to(mask, max_mm);
  const ScalarVolume inside = distance_to(
      mask_where(mask.grid, [&](std::size_t v) { return mask.values[v] == 0; }), max_mm);
  return volume_of(mask.grid, [&](std::size_t v) {
    return clamped(mask.values[v] != 0 ? double(inside.values[v]) - half_mm
                                       : half_mm - double(outside.values[v]),
                   kLabelClamp_mm);
  });
}

/// Makes `level` negative outside the scan, and zero half a voxel from its last voxels.
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
        level.at(i, j, k) = std::min(level.at(i, j, k), clamped(depth, kLabelClamp_mm));
      }
}

/// Air in sinuses, their mucosa, and small regions of soft tissue that skull and sinuses enclose.
/// The mandible encloses nothing: a joint space is not filled.
Mask sinus_filling(const PaddedScan& scan) {
  const Mask sinus = scan.where(Tissue::kSinus);
  const ScalarVolume to_sinus = distance_to(sinus, kLining_mm);
  const Mask solid = mask_where(scan.grid(), [&](std::size_t v) {
    const Tissue tissue = scan.labels.values[v];
    const bool lining = is_soft_tissue(tissue) && double(to_sinus.values[v]) <= kLining_mm;
    return tissue == Tissue::kBone || tissue == Tissue::kSinus || lining;
  });
  const Mask tight = closed(solid, kEntrance_mm);
  const Components rooms = connected_components(
      mask_where(scan.grid(), [&](std::size_t v) { return tight.values[v] == 0; }),
      Neighbors::kFaces);
  // Regions with other tissue, and the largest region, which is the rest of the patient, are not
  // filled.
  std::vector<std::uint8_t> is_kept = components_overlapping(
      rooms, mask_where(scan.grid(),
                        [&](std::size_t v) { return !is_soft_tissue(scan.labels.values[v]); }));
  is_kept[std::size_t(rooms.largest())] = 1;
  return mask_where(scan.grid(), [&](std::size_t v) {
    const auto room = std::size_t(rooms.component_of.values[v]);
    const bool filled = room != 0 && is_kept[room] == 0;
    return (solid.values[v] != 0 || filled) && !is_bone(scan.labels.values[v]);
  });
}

/// The smoothed function of the bone labeled `tissue` and of `filling`, which may be empty.
ScalarVolume level_of_label(const PaddedScan& scan, Tissue tissue, const Mask& filling) {
  const double limit_mm =
      clamp_limit_mm(scan.grid(), scan.options.bone_hu - kSoft_hu, kBoneSlope_hu_per_mm);
  const ScalarVolume raw = volume_of(scan.grid(), [&](std::size_t v) {
    const double depth_mm =
        (double(scan.ct.values[v]) - scan.options.bone_hu) / kBoneSlope_hu_per_mm;
    if (!filling.values.empty() && filling.values[v] != 0) return float(limit_mm);
    // Marrow is bone whatever its density; dense voxels that are not labeled bone are outside.
    if (scan.labels.values[v] == tissue)
      return clamped(depth_mm >= 0.0 ? depth_mm : limit_mm, limit_mm);
    // Another bone is as far outside as this bone is inside: if they touch, zero lies between.
    if (is_bone(scan.labels.values[v])) return float(-limit_mm);
    return clamped(outside_mm(scan.grid(), depth_mm), limit_mm);
  });
  return without_voxel_steps(raw, scan.options.bone_smoothing_mm, kBoneSteps_voxels);
}

/// What lies outside of the box in which skull and mandible are separated: it contains the
/// mandible, all voxels that separate_levels() changes, and those that the Gaussian reads for them.
Margin around_mandible(const PaddedScan& scan) {
  constexpr double kChanged_voxels = 5.0;
  constexpr double kGaussian_sigmas = 4.0;  // At least the length at which it is truncated.
  std::array<Index, 3> around{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double sigma_voxels = std::max(
        kBoneSteps_voxels, scan.options.bone_smoothing_mm / scan.grid().spacing_mm[Index(axis)]);
    around[axis] = Index(std::ceil(kChanged_voxels + kGaussian_sigmas * sigma_voxels));
  }
  return margin_around(scan.grid(), around,
                       [&](std::size_t v) { return scan.labels.values[v] == Tissue::kMandible; });
}

ScalarVolume bone_level(const PaddedScan& scan, Cavities cavities, Bones bones) {
  const Mask filling = cavities == Cavities::kFillSinuses ? sinus_filling(scan) : Mask{};
  ScalarVolume skull = level_of_label(scan, Tissue::kBone, filling);
  const Margin margin = around_mandible(scan);
  const bool has_mandible = margin.first[0] < scan.grid().size[0];
  ScalarVolume near;  // Within the box around the mandible.
  if (has_mandible) {
    const PaddedScan jaw{cropped(scan.ct, margin), cropped(scan.labels, margin), scan.options};
    ScalarVolume mandible = level_of_label(jaw, Tissue::kMandible, {});
    near = cropped(skull, margin);
    separate_levels(jaw.where(Tissue::kBone), jaw.where(Tissue::kMandible), near, mandible);
    if (bones == Bones::kAll)
      near = volume_of(jaw.grid(),
                       [&](std::size_t v) { return std::max(near.values[v], mandible.values[v]); });
    else if (bones == Bones::kMandible)
      near = std::move(mandible);
  }
  if (bones == Bones::kMandible)
    std::fill(skull.values.begin(), skull.values.end(), float(-kLabelClamp_mm));
  if (has_mandible) paste(near, margin, skull);
  return skull;
}

/// Positive where there is no air; airway and sinuses are air.
ScalarVolume non_air_level(const PaddedScan& scan) {
  const double limit_mm = clamp_limit_mm(
      scan.grid(), std::min(scan.options.skin_hu - kPureAir_hu, kSoft_hu - scan.options.skin_hu),
      kSkinSlope_hu_per_mm);
  const ScalarVolume raw = volume_of(scan.grid(), [&](std::size_t v) {
    const double depth_mm =
        (double(scan.ct.values[v]) - scan.options.skin_hu) / kSkinSlope_hu_per_mm;
    switch (scan.labels.values[v]) {
      case Tissue::kBackground:
      case Tissue::kAirway:
      case Tissue::kSinus:
        return clamped(outside_mm(scan.grid(), depth_mm), limit_mm);
      default:
        return clamped(depth_mm, limit_mm);
    }
  });
  return without_voxel_steps(raw, scan.options.skin_smoothing_mm, kSkinSteps_voxels);
}

/// Notes the volume of all components except the largest.
void note_dropped(const Components& parts, Progress& progress) {
  const Index all = std::accumulate(parts.voxels.begin() + 1, parts.voxels.end(), Index(0));
  const Index dropped = all - (parts.count() > 0 ? parts.voxels[std::size_t(parts.largest())] : 0);
  if (dropped == 0) return;
  progress.note(fmt::format(
      "{:.3g} ml of {:.3g} ml of soft tissue are not connected with the rest and are left out",
      double(dropped) * voxel_ml(parts.component_of.grid),
      double(all) * voxel_ml(parts.component_of.grid)));
}

}  // namespace

ScalarVolume bone_level(const image::CtVolume& ct, const LabelMap& labels, Cavities cavities,
                        const LevelOptions& options, Bones bones) {
  ScalarVolume level = bone_level(padded_scan(ct, labels, options), cavities, bones);
  cut_to_scan(level);
  return level;
}

ScalarVolume skin_level(const image::CtVolume& ct, const LabelMap& labels,
                        const LevelOptions& options) {
  const PaddedScan scan = padded_scan(ct, labels, options);
  const Mask near_background =
      dilated_by_one_voxel_or_more(scan.where(Tissue::kBackground), kLevelBlur_mm);
  const Mask near_air =
      dilated_by_one_voxel_or_more(mask_where(scan.grid(),
                                              [&](std::size_t v) {
                                                return scan.labels.values[v] == Tissue::kAirway ||
                                                       scan.labels.values[v] == Tissue::kSinus;
                                              }),
                                   kLevelBlur_mm);
  const ScalarVolume to_entrance = distance_to(mask_where(scan.grid(), [&](std::size_t v) {
    return scan.labels.values[v] == Tissue::kAirway && near_background.values[v] != 0;
  }));

  const ScalarVolume non_air = non_air_level(scan);
  ScalarVolume level = volume_of(scan.grid(), [&](std::size_t v) {
    // Inner air and its blurred walls, except where they reach the skin.
    const bool inner = near_air.values[v] != 0 && near_background.values[v] == 0;
    const double depth_mm = double(to_entrance.values[v]) - scan.options.nostril_depth_mm;
    return inner ? std::max(non_air.values[v], clamped(depth_mm, kLabelClamp_mm))
                 : non_air.values[v];
  });
  cut_to_scan(level);
  return level;
}

ScalarVolume soft_tissue_level(const image::CtVolume& ct, const LabelMap& labels,
                               const LevelOptions& options, Progress& progress) {
  const PaddedScan scan = padded_scan(ct, labels, options);
  const image::Grid& grid = scan.grid();

  // Bone next to the brain counts as brain, so that no thin layer remains on the inner table.
  const Mask near_brain = dilated_by_one_voxel_or_more(scan.where(Tissue::kBrain), kLevelBlur_mm);
  const Mask brain_and_table = mask_where(grid, [&](std::size_t v) {
    return scan.labels.values[v] == Tissue::kBrain ||
           (is_bone(scan.labels.values[v]) && near_brain.values[v] != 0);
  });
  const ScalarVolume brain =
      without_voxel_steps(signed_distance(brain_and_table), kLabelBorder_mm, kBoneSteps_voxels);
  const ScalarVolume bone = bone_level(scan, Cavities::kFillSinuses, Bones::kAll);
  const ScalarVolume non_air = non_air_level(scan);
  ScalarVolume level = volume_of(grid, [&](std::size_t v) {
    return std::min({non_air.values[v], -bone.values[v], -brain.values[v]});
  });

  // Skin over bone and the wings of the nose may be thin; sheets further inside may not. A sheet of
  // n voxels is about n spacings thick: half a voxel lies beyond the outer centers.
  const Mask inside = mask_where(grid, [&](std::size_t v) { return level.values[v] > 0.0F; });
  const double radius_mm = 0.5 * (options.thinnest_tissue_mm + grid.spacing_mm.minCoeff());
  const Mask thick = opened(inside, radius_mm);
  const ScalarVolume to_background = distance_to(scan.where(Tissue::kBackground), kSkinLayer_mm);
  const Components parts =
      connected_components(mask_where(grid,
                                      [&](std::size_t v) {
                                        return thick.values[v] != 0 ||
                                               (inside.values[v] != 0 &&
                                                double(to_background.values[v]) <= kSkinLayer_mm);
                                      }),
                           Neighbors::kFaces);
  const std::int32_t largest = parts.largest();
  note_dropped(parts, progress);
  // The largest component, extended by the distance its surface may lie beyond its outer voxels.
  const Mask kept = dilated_by_one_voxel_or_more(
      mask_where(
          grid,
          [&](std::size_t v) { return largest != 0 && parts.component_of.values[v] == largest; }),
      kLevelBlur_mm);
  const ScalarVolume room =
      without_voxel_steps(signed_distance(kept), kLabelBorder_mm, kBoneSteps_voxels);
  level = volume_of(grid, [&](std::size_t v) { return std::min(level.values[v], room.values[v]); });
  cut_to_scan(level);
  return level;
}

}  // namespace lefort::anatomy
