/// \file
/// Tells bone, mandible, facial tissue, brain, airway and sinuses apart in a head CT, and drops
/// what is not the patient.
#pragma once

#include <lefort/anatomy/label_map.h>
#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/image/volume.h>

namespace lefort::anatomy {

/// Where one tissue ends and the next begins. Lengths are in mm, so that they mean the same in
/// every scan; one below the voxel size acts as one voxel.
struct SegmentationOptions {
  double bone_hu = 226.0;   ///< Bone is at least this dense; must exceed skin_hu.
  double skin_hu = -300.0;  ///< The patient is at least this dense, air is below.

  /// Bone parts smaller than this are islands and become soft tissue; >= 0.
  double min_bone_ml = 0.2;
  /// Air entrances up to twice as wide belong to the patient, such as nostrils; > 0.
  double nostril_radius_mm = 5.0;
  /// Openings up to twice as wide do not make a sinus part of the airway; > 0.
  double ostium_radius_mm = 2.0;
  /// Pockets of air in soft tissue smaller than this are soft tissue; >= 0.
  double min_air_ml = 0.05;
  /// A scan that needs more memory is refused before it is touched; > 0. See segment_tissue().
  double max_memory_gib = 16.0;
};

/// Labels every voxel of a head CT.
///
/// Bone is what is dense and hangs together, with the marrow it encloses; the mandible is told from
/// the rest where the scan shows it apart (find_mandible.h). The brain is found from
/// the part of the soft tissue that sees bone in nearly all directions; it ends at the narrowest
/// place of every opening of the skull, be it a foramen or a defect, with a smooth border. A scan
/// without a cranial cavity has no brain, which is no error.
///
/// \param ct        a head, in HU; the scan may cut it off on any side. Table and head holder are
///   taken for background unless they grow together with the head.
/// \param options   see SegmentationOptions.
/// \param progress  is told the share of the work done, and may cancel.
/// \returns one label per voxel on the grid of `ct`, or
///   - kInvalidArgument  an option lies outside its range, `ct` contradicts its own grid, or has so
///                       many voxels that options.max_memory_gib does not suffice;
///   - kAnatomyMissing   the scan is empty or constant, or shows no skin or no bone;
///   - kCancelled        `progress` asked to stop.
/// \note Same bits for any number of threads.
/// \note Memory: 40 bytes per voxel at most, the scan itself not counted.
[[nodiscard]] Result<LabelMap> segment_tissue(const image::CtVolume& ct,
                                              const SegmentationOptions& options = {},
                                              Progress& progress = Progress::none());

}  // namespace lefort::anatomy
