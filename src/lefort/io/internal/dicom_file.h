/// \file
/// Safe parsing of the data elements of a DICOM file (PS3.10).
///
/// GDCM, as built by Debian, aborts the program on truncated files. It is therefore used for
/// compressed pixels only (dicom_codec.h).
#pragma once

#include <lefort/core/error.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace lefort::io {

/// Group and element number of a data element, as 0xGGGGEEEE.
using DicomTag = std::uint32_t;

/// Contents of a DICOM file; the views refer to the parsed bytes.
struct DicomElements {
  std::map<DicomTag, std::string_view> values;  ///< Of the top level; sequences are not parsed.
  std::string_view pixels;                      ///< As stored; empty if there are none.
  bool is_compressed = false;     ///< `pixels` contains fragments of a codec's stream.
  std::optional<Error> damage{};  ///< Why parsing ended after `values`.
};

/// Whether the file contains "DICM" after 128 bytes.
[[nodiscard]] bool has_dicom_magic(const std::filesystem::path& file);

/// Parses a file with this magic number, up to its pixels.
///
/// \param bytes  the whole file; must outlive the result.
/// \returns the elements that can be read; those of a damaged file may still contain its series.
///   `damage` is kFileCorrupt (truncated, damaged) or kFileUnsupported (a rare transfer syntax),
///   with a message that does not contain the file name.
[[nodiscard]] DicomElements parse_dicom(std::string_view bytes);

}  // namespace lefort::io
