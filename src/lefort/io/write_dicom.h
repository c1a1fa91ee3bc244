/// \file
/// Writes a computed CT as DICOM files.
#pragma once

#include <lefort/core/error.h>
#include <lefort/image/volume.h>

#include <filesystem>
#include <string>

namespace lefort::io {

/// Attributes that are equal in all files of a series.
struct DicomSeriesText {
  std::string patient_name;  ///< Family^Given.
  std::string description;   ///< Of the series.
  std::uint64_t number = 1;  ///< Determines the identifiers of patient, study and series.
};

/// Writes one slice as CT Image (PS3.3, A.3): explicit little endian, 16 bits, HU + 1024.
///
/// \param target  the file.
/// \param slice   one voxel along k; values >= -1024 HU.
/// \param number  of the slice in its series, from 1.
/// \param text    attributes of the series.
/// \returns nothing, or kFileUnwritable.
[[nodiscard]] Result<void> write_dicom_slice(const std::filesystem::path& target,
                                             const image::CtVolume& slice, Index number,
                                             const DicomSeriesText& text);

}  // namespace lefort::io
