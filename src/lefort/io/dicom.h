/// \file
/// A CT from a folder of DICOM files.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/io/imported_volume.h>

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lefort::io {

/// One series of a folder, as people choose it. Nothing in it identifies a patient.
struct DicomSeriesInfo {
  int number = 0;  ///< What read_dicom_series() takes.
  std::string modality;
  Index images = 0;
  Index columns = 0, rows = 0;
  std::optional<std::array<double, 2>> pixel_mm{};  ///< Between columns, between rows.
  std::optional<double> step_mm{};                  ///< From slice to slice of the result.
  std::string orientation{};                        ///< "axial", "coronal", "sagittal" or nothing.
  std::string kernel{};  ///< The scanner's word for how sharp it is, if it is a plain code.
  bool is_usable = false;
  std::string problem{};  ///< Why it is not usable.
  std::vector<std::string> warnings{};
};

/// Lists all series in `folder` and its subfolders, without reading their pixels.
///
/// \returns at least one, or the errors of read_dicom_series().
[[nodiscard]] Result<std::vector<DicomSeriesInfo>> list_dicom_series(
    const std::filesystem::path& folder, Progress& progress = Progress::none());

/// Reads the CT series in `folder` and its subfolders.
///
/// Files come in any order and may have any name; others than DICOM are passed over, and so are
/// damaged ones of other series, with a warning. Files so damaged that not even their series is
/// known may be slices: more of them than a fifth of the slices are an error. Slices are sorted
/// along their normal, rescaled to Hounsfield units, and checked: one orientation and pixel
/// spacing, no slice missing or twice, none beside the stack or off its even distance. What a
/// tilted gantry sheared, and runs of slices of several distances, are resampled to a regular grid.
///
/// \param series  which one, counted from 1 as the error lists them; 0: the only CT there is.
/// \returns as import_volume(). Nothing that identifies a patient is in a message: files are
///   counted in the order of their names instead of named.
[[nodiscard]] Result<ImportedVolume> read_dicom_series(const std::filesystem::path& folder,
                                                       int series = 0,
                                                       Progress& progress = Progress::none());

}  // namespace lefort::io
