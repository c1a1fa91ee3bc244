/// \file
/// The required header elements of a DICOM file, and its pixels.
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

/// The tags that position a slice in the patient. No name, date or other text of the patient.
struct DicomHeader {
  std::filesystem::path file;         ///< Never shown, since it may contain the patient's name.
  Index file_number = 0;              ///< In the order of file names in the folder, from 1.
  std::optional<Index> slice_number;  ///< Assigned by the scanner; need not be unique.
  std::string series_uid;             ///< Groups files; never shown or stored.
  std::string instance_uid;           ///< Identifies copies of a slice; never shown or stored.
  std::string modality;               ///< "CT", "RTSTRUCT", ...; "unknown" if it is not a code.
  std::string kernel;  ///< Of the reconstruction, for example "H60s"; empty if it is not a code.
  bool is_localizer = false;
  Index columns = 0, rows = 0;  ///< 0 for objects that are not images.
  Index frames = 1;
  Index samples_per_pixel = 1;
  std::optional<Vec3> position_L;                         ///< Center of the first pixel.
  std::optional<std::array<Vec3, 2>> axes_L;              ///< Along a row, along a column.
  std::optional<std::array<double, 2>> pixel_spacing_mm;  ///< Distance of columns, of rows.
  std::optional<double> rescale_slope;
  std::optional<double> rescale_intercept;
  double gantry_tilt_deg = 0.0;  ///< As reported by the scanner, otherwise 0.
  std::optional<Error> damage;   ///< Why the rest of the file could not be read.
};

/// Returns the name of a file in messages: "slice 12 (file 5)", or "file 5" if its slice is
/// unknown.
[[nodiscard]] std::string name_of(const DicomHeader& header);

/// Reads the header of one file.
///
/// \param file         any file.
/// \param file_number  number of the file in messages.
/// \returns nothing if it is not DICOM; the header, with `damage` if only its beginning could be
///   read; or kFileCorrupt or kFileUnsupported, with the number of the file in the message, if its
///   series could not be read.
[[nodiscard]] Result<std::optional<DicomHeader>> read_dicom_header(
    const std::filesystem::path& file, Index file_number);

/// Reads the stored values of a slice, row by row, before rescaling.
///
/// \param header    of a file with one frame and one value per pixel.
/// \param progress  requests to stop.
/// \returns columns * rows values, or kFileCorrupt or kFileUnsupported with name_of() in the
///   message, or kCancelled.
[[nodiscard]] Result<std::vector<double>> read_dicom_pixels(const DicomHeader& header,
                                                            Progress& progress);

}  // namespace lefort::io
