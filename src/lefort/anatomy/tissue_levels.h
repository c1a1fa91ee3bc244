/// \file
/// Smooth scalar volumes whose zero surface is the border of a tissue.
///
/// A level is positive inside, negative outside, and in mm: near its border it is about the
/// distance to it, and it is clamped a few mm away. Users interpolate it trilinearly. Its grid is
/// the scan's, two voxels longer on every side with negative values there, so that zero surfaces
/// are closed even where the scan cuts the patient off. Levels of neighbors are made of the same
/// numbers: where tissue touches bone, or air, both zero surfaces coincide.
#pragma once

#include <lefort/anatomy/label_map.h>
#include <lefort/core/progress.h>
#include <lefort/image/volume.h>

namespace lefort::anatomy {

/// Whether the sinuses are holes in the bone or part of it.
enum class Cavities {
  kKeep,         ///< Bone as it is.
  kFillSinuses,  ///< One solid: for contact, since a sinus wall is thinner than a load step.
};

/// The thresholds must be those the labels were made with.
struct LevelOptions {
  double bone_hu = 226.0;
  double skin_hu = -300.0;
  /// Sigma of the Gaussian that takes stair-steps and noise off the surfaces at bone_hu and
  /// skin_hu; bone gets less, for its thin walls. Along an axis of coarser voxels it is as much as
  /// their steps need: 0.8 voxels for bone, 1 for skin. >= 0; 0 leaves all as it is.
  double bone_smoothing_mm = 0.8;
  double skin_smoothing_mm = 1.0;
  double thinnest_tissue_mm = 2.5;  ///< Thinner sheets are no soft tissue to be meshed.
  double nostril_depth_mm = 5.0;    ///< So deep is the skin surface drawn into the nostrils.
};

/// Bone: the surface at `bone_hu` around the voxels labeled bone, all else left out.
///
/// \pre `labels` lies on the grid of `ct`.
[[nodiscard]] image::ScalarVolume bone_level(const image::CtVolume& ct, const LabelMap& labels,
                                             Cavities cavities, const LevelOptions& options = {});

/// The patient as a whole: background outside, everything else inside, the surface at `skin_hu`.
///
/// Airway and sinuses count as inside, but nostrils and ear canals are open for their first
/// `nostril_depth_mm`: the face has nostrils, and no inner surface of the nose.
///
/// \pre `labels` lies on the grid of `ct`.
[[nodiscard]] image::ScalarVolume skin_level(const image::CtVolume& ct, const LabelMap& labels,
                                             const LevelOptions& options = {});

/// The soft tissue that deforms: inside the skin, outside bone with filled sinuses, outside the
/// airway, without the brain; without sheets thinner than `thinnest_tissue_mm` (turbinates, the
/// blur between bone and air); its largest part only.
///
/// \param progress  is told as a note how much the smaller parts hold that are left out.
/// \pre `labels` lies on the grid of `ct`.
[[nodiscard]] image::ScalarVolume soft_tissue_level(const image::CtVolume& ct,
                                                    const LabelMap& labels,
                                                    const LevelOptions& options = {},
                                                    Progress& progress = Progress::none());

}  // namespace lefort::anatomy
