/// \file
/// A CT from a folder of DICOM files.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/io/imported_volume.h>

#include <filesystem>

namespace lefort::io {

/// Reads the CT series in `folder` (without its subfolders).
///
/// Files come in any order and may have any name; others than DICOM are passed over, and so are
/// damaged ones of other series, with a warning. Slices are
/// sorted along their normal, rescaled to Hounsfield units, and checked: one orientation and pixel
/// spacing, no slice missing or twice, none beside the stack or off its even distance, no gantry
/// tilt.
///
/// \param series  which one, counted from 1 as the error lists them; 0: the only CT there is.
/// \returns as import_volume(). Nothing that identifies a patient is in a message: files are
///   counted in the order of their names instead of named.
[[nodiscard]] Result<ImportedVolume> read_dicom_series(const std::filesystem::path& folder,
                                                       int series = 0,
                                                       Progress& progress = Progress::none());

}  // namespace lefort::io
