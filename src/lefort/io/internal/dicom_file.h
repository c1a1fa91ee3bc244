/// \file
/// The elements of a DICOM file (PS3.10), safely.
///
/// GDCM, as Debian builds it, aborts the program on files that are cut off. So we take files apart
/// ourselves, and leave to it compressed pixels only (dicom_codec.h).
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

/// What a DICOM file holds; the views look into the bytes it was parsed from.
struct DicomElements {
  std::map<DicomTag, std::string_view> values;  ///< Of the outermost level, without sequences.
  std::string_view pixels;                      ///< As stored; empty if there are none.
  bool is_compressed = false;                   ///< `pixels` are fragments of a codec's stream.
  std::optional<Error> damage{};                ///< Why nothing behind `values` could be read.
};

/// Whether the file says it is DICOM: "DICM" after 128 bytes.
[[nodiscard]] bool has_dicom_magic(const std::filesystem::path& file);

/// Takes a file that has the magic apart, up to the pixels.
///
/// \param bytes  the whole file; must outlive the result.
/// \returns the elements, as far as they can be read: of a damaged file they may still tell to
///   which series it belongs. `damage` is kFileCorrupt (truncated, damaged) or kFileUnsupported (a
///   rare transfer syntax), with a message that does not name the file.
[[nodiscard]] DicomElements parse_dicom(std::string_view bytes);

}  // namespace lefort::io
