/// \file
/// Segments skull, mandible, soft tissue, brain, airway and sinuses in a head CT, and removes
/// everything that is not the patient.
#pragma once

#include <lefort/anatomy/label_map.h>
#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/image/volume.h>

namespace lefort::anatomy {

/// Parameters of the segmentation. Lengths are in mm, so they do not depend on the voxel size; a
/// length below the voxel size acts as one voxel.
struct SegmentationOptions {
  double bone_hu = 226.0;   ///< Min CT number of bone; must exceed skin_hu.
  double skin_hu = -300.0;  ///< Min CT number of the patient; air is below.

  /// Smaller connected components of bone are islands and become soft tissue; >= 0.
  double min_bone_ml = 0.2;
  /// The air behind openings up to twice this wide, such as nostrils, belongs to the patient; > 0,
  /// <= 50.
  double nostril_radius_mm = 5.0;
  /// A sinus whose ostium is up to twice as wide as this is not part of the airway; > 0.
  double ostium_radius_mm = 2.0;
  /// Smaller air pockets in soft tissue become soft tissue; >= 0.
  double min_air_ml = 0.05;
  /// Scans that need more memory are rejected before any work; > 0. See segment_tissue().
  double max_memory_gib = 16.0;
};

/// Labels every voxel of a head CT.
///
/// Bone: connected dense components, with the marrow they enclose. The mandible has its own label
/// if it can be separated from the skull (find_mandible.h); only then does sharpen_bone() remove
/// the blurred border of bone. Brain: the soft tissue from which rays hit bone in at least 85 % of
/// those of 26 directions that do not leave the scan inside the patient (13 or more). A watershed
/// extends this region to the narrowest cross-section of each opening of the skull, whether foramen
/// or defect; the border there is smooth. A scan without a cranial cavity has no brain; this is not
/// an error.
///
/// \param ct        a head, in HU; the scan may truncate it on any side. Table and head holder
///   become background unless they are fused with the head.
/// \param options   see SegmentationOptions.
/// \param progress  receives the fraction done; may cancel.
/// \returns one label per voxel on the grid of `ct`, or
///   - kInvalidArgument  an option is out of range, the grid of `ct` is invalid or does not match
///     the values, or options.max_memory_gib is exceeded;
///   - kAnatomyMissing   the scan is empty or constant, or shows no skin, no bone, or no air around
///     the patient;
///   - kCancelled        `progress` requested a stop.
/// \note The result has the same bits for any number of threads.
/// \note Memory: at most 40 bytes per voxel, in addition to the scan.
[[nodiscard]] Result<LabelMap> segment_tissue(const image::CtVolume& ct,
                                              const SegmentationOptions& options = {},
                                              Progress& progress = Progress::none());

}  // namespace lefort::anatomy
