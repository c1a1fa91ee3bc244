/// \file
/// Level-set functions of tissues: smooth volumes whose zero surface is the border of a tissue.
///
/// Their sign is **positive inside** and negative outside (docs/conventions.md), unlike that of
/// distance fields. Near the border the value is about the distance to it in mm; further away it is
/// clamped, to 1 to 3 mm. Values between voxels are interpolated trilinearly. The grid is that of
/// the scan, extended by two voxels with negative values on every side, so that zero surfaces are
/// closed even where the scan truncates the patient. Functions of adjacent tissues are computed
/// from the same values: where tissue touches bone or air, both zero surfaces coincide.
#pragma once

#include <lefort/anatomy/label_map.h>
#include <lefort/core/progress.h>
#include <lefort/image/volume.h>

namespace lefort::anatomy {

/// Whether sinuses are cavities of the bone or part of it.
enum class Cavities {
  kKeep,  ///< Sinuses are cavities.
  /// Sinuses are solid: for contact, because a sinus wall may be thinner than the motion of a bone
  /// in one load increment.
  kFillSinuses,
};

/// Which bones a level-set function contains.
enum class Bones {
  kAll,       ///< Skull and mandible, as separate surfaces.
  kSkull,     ///< The voxels labeled kBone.
  kMandible,  ///< The voxels labeled kMandible.
};

/// Thresholds and smoothing. Thresholds must be those of the segmentation.
struct LevelOptions {
  double bone_hu = 226.0;
  double skin_hu = -300.0;
  /// Sigma of the Gaussian that removes voxel steps and noise at bone_hu and skin_hu; bone is
  /// smoothed less because of its thin walls. Along an axis with coarse voxels it is at least 0.8
  /// voxels for bone and 1 for skin. >= 0; 0 means no smoothing.
  double bone_smoothing_mm = 0.8;
  double skin_smoothing_mm = 1.0;
  double thinnest_tissue_mm = 2.5;  ///< See soft_tissue_level().
  double nostril_depth_mm = 5.0;    ///< Depth up to which the skin surface follows the nostrils.
};

/// Bone: the surface at `bone_hu` around the voxels labeled as bone, without other dense objects.
///
/// Skull and mandible are smoothed one by one, and separated by separate_levels(), even where their
/// voxels touch, as in a narrow joint or between teeth. The function of kAll is the maximum of
/// those of kSkull and kMandible. Only sinuses of the skull are filled.
///
/// \param ct        the scan.
/// \param labels    of the scan. \pre it is on the grid of `ct`.
/// \param cavities  whether sinuses are filled.
/// \param options   thresholds and smoothing.
/// \param bones     which bones; the others are outside.
[[nodiscard]] image::ScalarVolume bone_level(const image::CtVolume& ct, const LabelMap& labels,
                                             Cavities cavities, const LevelOptions& options = {},
                                             Bones bones = Bones::kAll);

/// The whole patient: the surface at `skin_hu` around everything except the background.
///
/// Airway and sinuses are inside, but nostrils and ear canals are open up to `nostril_depth_mm`:
/// the face has nostrils, but not the inner surface of the nose.
///
/// \param ct       the scan.
/// \param labels   of the scan. \pre it is on the grid of `ct`.
/// \param options  thresholds and smoothing.
[[nodiscard]] image::ScalarVolume skin_level(const image::CtVolume& ct, const LabelMap& labels,
                                             const LevelOptions& options = {});

/// The deformable soft tissue: inside the skin, outside of bone with filled sinuses and of the
/// airway, without the brain; more than 5 mm from the background, also without sheets thinner than
/// `thinnest_tissue_mm` (turbinates, the blur between bone and air). Only the largest connected
/// component.
///
/// \param ct        the scan.
/// \param labels    of the scan. \pre it is on the grid of `ct`.
/// \param options   thresholds and smoothing.
/// \param progress  receives a note with the volume of the components that are left out.
[[nodiscard]] image::ScalarVolume soft_tissue_level(const image::CtVolume& ct,
                                                    const LabelMap& labels,
                                                    const LevelOptions& options = {},
                                                    Progress& progress = Progress::none());

}  // namespace lefort::anatomy
