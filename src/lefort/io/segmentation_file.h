/// \file
/// Label maps as `.seg.nrrd`, the segmentation file of 3D Slicer, with names and colors.
#pragma once

#include <lefort/anatomy/label_map.h>
#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/image/volume.h>
#include <lefort/predict/boundary_labels.h>

#include <filesystem>

namespace lefort::io {

/// Writes `labels` as a compressed `.seg.nrrd` with one segment per tissue of kTissueStyles, whole
/// or not at all. Equal label maps give equal bytes.
///
/// \returns nothing, or kInvalidArgument (the ending, or a grid that check_grid() refuses) or
///   kFileUnwritable.
[[nodiscard]] Result<void> write_segmentation(const std::filesystem::path& target,
                                              const anatomy::LabelMap& labels);

/// Reads a `.seg.nrrd`, ours or one edited in Slicer, on the grid of the file.
///
/// Segments are matched to tissues by name, in any case, else by what their terminology calls their
/// type; any with the word muscle are muscle, such as left_masseter_muscle. Label values and layers
/// are free. Where segments of several layers overlap, the higher layer wins; but muscle, a part of
/// the soft tissue, wins over soft tissue and over nothing else, whatever the layers. Voxels of no
/// segment, or of one that has no tissue's name, are background. Slicer crops files: see the other
/// overload.
///
/// \returns the labels, or, with a message that does not name the file,
///   - kFileNotFound     there is no such file;
///   - kFileUnsupported  not a `.seg.nrrd`, no segment at all, or none with a tissue's name;
///   - kFileCorrupt      truncated, damaged, or its header contradicts itself.
[[nodiscard]] Result<anatomy::LabelMap> read_segmentation(const std::filesystem::path& source);

/// The same on the grid of the scan it belongs to: what the file leaves out is background.
///
/// \param progress  is told as notes which segments have no tissue's name, and which share of the
///   labeled voxels lies outside the scan.
/// \returns also kFileCorrupt when the file's voxels do not lie on voxels of `grid`, or none that
///   is labeled lies within it: then it belongs to another scan.
[[nodiscard]] Result<anatomy::LabelMap> read_segmentation(const std::filesystem::path& source,
                                                          const image::Grid& grid,
                                                          Progress& progress = Progress::none());

/// The same of what was painted on the tissue's boundary, with one segment per label of
/// predict::kBoundaryLabelStyles; read_boundary_labels() takes any part of the scan's grid.
[[nodiscard]] Result<void> write_boundary_labels(const std::filesystem::path& target,
                                                 const predict::BoundaryLabelMap& painted);

/// Reads what was painted on the tissue's boundary: a `.seg.nrrd` whose segments are called as in
/// predict::kBoundaryLabelStyles, in any case, on the grid of the scan as above.
///
/// \returns as above, and kFileUnsupported for a segment of any other name.
[[nodiscard]] Result<predict::BoundaryLabelMap> read_boundary_labels(
    const std::filesystem::path& source, const image::Grid& grid,
    Progress& progress = Progress::none());

}  // namespace lefort::io
