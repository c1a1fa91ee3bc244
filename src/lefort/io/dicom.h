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

/// A series of a folder, for the user to choose from. It contains nothing that identifies a
/// patient.
struct DicomSeriesInfo {
  int number = 0;  ///< Number to pass to read_dicom_series().
  std::string modality;
  Index images = 0;
  Index columns = 0, rows = 0;
  std::optional<std::array<double, 2>> pixel_mm{};  ///< Distance of columns, of rows.
  std::optional<double> step_mm{};                  ///< Slice distance of the result.
  std::string orientation{};                        ///< "axial", "coronal", "sagittal" or empty.
  std::string kernel{};  ///< Of the reconstruction; empty unless it is a plain code.
  bool is_usable = false;
  std::string problem{};  ///< Why it is not usable.
  std::vector<std::string> warnings{};
};

/// Lists all series in `folder` and its subfolders, without reading their pixels.
/// \param folder    a folder with DICOM files.
/// \param progress  stage, requests to stop.
/// \returns at least one series, or the errors of read_dicom_series().
[[nodiscard]] Result<std::vector<DicomSeriesInfo>> list_dicom_series(
    const std::filesystem::path& folder, Progress& progress = Progress::none());

/// Reads the CT series in `folder` and its subfolders.
///
/// Files may have any order and name. Files that are not DICOM and damaged files of other series
/// are ignored with a warning. A file whose series cannot be read may be a slice of this series:
/// such files are an error if they are more than a fifth of the slices.
///
/// The slices are sorted along their normal, rescaled to Hounsfield units and checked: equal
/// orientation, pixel spacing and distances; no slice missing, duplicated or displaced sideways.
/// A stack that is sheared by gantry tilt, or has runs of different slice distances, is resampled
/// to a regular grid.
///
/// \param folder    a folder with DICOM files.
/// \param series    number of the series, from 1, as the error message lists them; 0: the only CT.
/// \param progress  stages, requests to stop.
/// \returns as import_volume(). Messages contain nothing that identifies a patient: files are
///   numbered in the order of their names.
[[nodiscard]] Result<ImportedVolume> read_dicom_series(const std::filesystem::path& folder,
                                                       int series = 0,
                                                       Progress& progress = Progress::none());

}  // namespace lefort::io
