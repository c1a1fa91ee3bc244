/// \file
/// What we need to know of one DICOM file, and its pixels.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/core/types.h>

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lefort::io {

/// The tags that place a slice in the patient. No name, date or other text of the patient.
struct DicomHeader {
  std::filesystem::path file;         ///< Never shown: people name files after patients.
  Index file_number = 0;              ///< In the order of the folder's names, from 1.
  std::optional<Index> slice_number;  ///< The scanner's; free, need not be unique.
  std::string series_uid;             ///< Groups files; never shown, never kept.
  std::string instance_uid;           ///< Tells copies of one slice; never shown, never kept.
  std::string modality;  ///< "CT", "RTSTRUCT", ...; "unknown" if it is no plain code word.
  std::string kernel;    ///< Of reconstruction, as "H60s"; empty if it is no plain code.
  bool is_localizer = false;
  Index columns = 0, rows = 0;  ///< 0 for objects that are no images.
  Index frames = 1;
  Index samples_per_pixel = 1;
  std::optional<Vec3> position_L;                         ///< Center of the first pixel.
  std::optional<std::array<Vec3, 2>> axes_L;              ///< Along a row, along a column.
  std::optional<std::array<double, 2>> pixel_spacing_mm;  ///< Between columns, between rows.
  std::optional<double> rescale_slope;
  std::optional<double> rescale_intercept;
  double gantry_tilt_deg = 0.0;  ///< What the scanner says, 0 if nothing.
  std::optional<Error> damage;   ///< Why the rest of the file cannot be read.
};

/// What messages call a file: "slice 12 (file 5)", or "file 5" if its slice is unknown.
[[nodiscard]] std::string name_of(const DicomHeader& header);

/// Reads the header of one file.
///
/// \param file_number  what messages call the file.
/// \returns nothing if it is not DICOM; the header, with `damage` if only its beginning could be
///   read; or kFileCorrupt or kFileUnsupported, with the file's number in the message, if not even
///   its series is known.
[[nodiscard]] Result<std::optional<DicomHeader>> read_dicom_header(
    const std::filesystem::path& file, Index file_number);

/// Reads the stored values of a slice, row by row, before rescaling.
///
/// \param header  of a file with one frame and one value per pixel.
/// \returns columns * rows values, or kFileCorrupt or kFileUnsupported with name_of() in the
///   message, or kCancelled.
[[nodiscard]] Result<std::vector<double>> read_dicom_pixels(const DicomHeader& header,
                                                            Progress& progress);

}  // namespace lefort::io
