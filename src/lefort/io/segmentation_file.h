/// \file
/// Label maps in `.seg.nrrd`, the segmentation file of 3D Slicer, with names and colors.
#pragma once

#include <lefort/anatomy/find_teeth.h>
#include <lefort/anatomy/label_map.h>
#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/image/volume.h>
#include <lefort/predict/boundary_labels.h>

#include <filesystem>

namespace lefort::io {

/// Writes `labels` atomically as a compressed `.seg.nrrd` with one segment per tissue of
/// kTissueStyles. Equal label maps give equal bytes.
///
/// \param target  ends in .seg.nrrd.
/// \param labels  to write.
/// \returns nothing, kInvalidArgument (the ending, or a grid that check_grid() rejects) or
///   kFileUnwritable.
[[nodiscard]] Result<void> write_segmentation(const std::filesystem::path& target,
                                              const anatomy::LabelMap& labels);

/// Reads a `.seg.nrrd` of lefort or Slicer, on the grid of the file.
///
/// Segments are matched to tissues by name, ignoring case, else by the type in their terminology; a
/// name with the word muscle, such as left_masseter_muscle, is muscle. Label values and layers are
/// arbitrary. Where segments overlap, the higher layer takes precedence. Muscle is the exception:
/// in any layer, it takes precedence over soft tissue, of which it is part, and over nothing else.
/// Voxels of no segment, or of a segment that matches no tissue, are background. Slicer crops
/// files: see the other overload.
///
/// \param source  a `.seg.nrrd`.
/// \returns the labels, or an error whose message does not contain the file name:
///   - kFileNotFound     the file does not exist;
///   - kFileUnsupported  not a `.seg.nrrd`, no segment, or none that matches a tissue;
///   - kFileCorrupt      truncated, damaged, or its header is inconsistent.
[[nodiscard]] Result<anatomy::LabelMap> read_segmentation(const std::filesystem::path& source);

/// As above, on the grid of the scan: voxels outside the file are background.
///
/// \param source    a `.seg.nrrd`.
/// \param grid      of the scan.
/// \param progress  receives notes: segments that match no tissue, and the fraction of labeled
///   voxels outside the scan.
/// \returns as above; also kFileCorrupt if the voxels of the file do not coincide with voxels of
///   `grid`, or no labeled voxel is inside `grid`, since the file then belongs to another scan; or
///   kCancelled.
[[nodiscard]] Result<anatomy::LabelMap> read_segmentation(const std::filesystem::path& source,
                                                          const image::Grid& grid,
                                                          Progress& progress = Progress::none());

/// Writes numbered teeth atomically, with one segment for each tooth: "tooth 11". The label is the
/// FDI number.
///
/// \param target   ends in .seg.nrrd.
/// \param numbers  FDI numbers, 0 elsewhere.
/// \returns as write_segmentation().
[[nodiscard]] Result<void> write_numbered_teeth(const std::filesystem::path& target,
                                                const image::Volume<std::uint8_t>& numbers);

/// Writes the teeth atomically, with one segment per jaw: anatomy::kToothStyles. They are a file of
/// their own because a tooth is bone of its jaw in the label map.
///
/// \param target  ends in .seg.nrrd.
/// \param teeth   to write.
/// \returns as write_segmentation().
[[nodiscard]] Result<void> write_teeth(const std::filesystem::path& target,
                                       const anatomy::ToothMap& teeth);

/// Reads a tooth map: segments named as write_teeth() or write_numbered_teeth() name them, ignoring
/// case, on the grid of the scan or a box cropped from it.
///
/// \param source  a .seg.nrrd.
/// \param grid    of the scan.
/// \returns the FDI number of each voxel, or without numbers its jaw (anatomy::Tooth), 0 elsewhere;
///   or the errors of read_segmentation(); or kFileUnsupported if a segment has another name.
[[nodiscard]] Result<image::Volume<std::uint8_t>> read_teeth(const std::filesystem::path& source,
                                                             const image::Grid& grid,
                                                             Progress& progress = Progress::none());

/// Writes the labels painted on the tissue boundary atomically, with one segment per label of
/// predict::kBoundaryLabelStyles.
///
/// \param target   ends in .seg.nrrd.
/// \param painted  labels; their grid is that of the scan, or a box cropped from it.
/// \returns as write_segmentation().
[[nodiscard]] Result<void> write_boundary_labels(const std::filesystem::path& target,
                                                 const predict::BoundaryLabelMap& painted);

/// Reads the labels painted on the tissue boundary: a `.seg.nrrd` whose segments are named as in
/// predict::kBoundaryLabelStyles, ignoring case, on the grid of the scan.
///
/// \param source    a `.seg.nrrd`.
/// \param grid      of the scan.
/// \param progress  receives notes.
/// \returns as read_segmentation(); also kFileUnsupported for a segment with another name.
[[nodiscard]] Result<predict::BoundaryLabelMap> read_boundary_labels(
    const std::filesystem::path& source, const image::Grid& grid,
    Progress& progress = Progress::none());

}  // namespace lefort::io
