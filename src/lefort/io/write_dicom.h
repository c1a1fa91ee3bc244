/// \file
/// Writes a CT as DICOM files, for scans that were computed.
#pragma once

#include <lefort/core/error.h>
#include <lefort/image/volume.h>

#include <filesystem>
#include <string>

namespace lefort::io {

/// What the files of one series share.
struct DicomSeriesText {
  std::string patient_name;  ///< Family^Given.
  std::string description;   ///< Of the series.
  std::uint64_t number = 1;  ///< Makes the identifiers of study and series: equal for equal ones.
};

/// Writes one slice as CT Image (PS3.3, A.3): explicit little endian, 16 bits, HU + 1024.
///
/// \param slice   one voxel along k.
/// \param number  of the slice within its series, from 1.
/// \returns nothing, or kFileUnwritable.
[[nodiscard]] Result<void> write_dicom_slice(const std::filesystem::path& target,
                                             const image::CtVolume& slice, Index number,
                                             const DicomSeriesText& text);

}  // namespace lefort::io
