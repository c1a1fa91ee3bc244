/// \file
/// Distance fields on disk: *.field, little-endian, with a checksum.
#pragma once

#include <lefort/core/error.h>
#include <lefort/field/distance_field.h>

#include <filesystem>
#include <string>
#include <string_view>

namespace lefort::io {

/// Writes a field, whole or not at all. Equal fields give equal bytes.
/// \returns kInvalidArgument if the name does not end in .field, else as write_atomically.
[[nodiscard]] Result<void> write_field(const std::filesystem::path& path,
                                       const field::DistanceField& field);

/// \returns kFileNotFound; kFileUnsupported for a foreign file or another version; kFileCorrupt if
///   it is truncated, damaged or contradicts itself. Memory used is bounded by the file's size.
[[nodiscard]] Result<field::DistanceField> read_field(const std::filesystem::path& path);

/// The bytes of the file, and back.
[[nodiscard]] std::string encode_field(const field::DistanceField& field);
[[nodiscard]] Result<field::DistanceField> decode_field(std::string_view bytes);

}  // namespace lefort::io
