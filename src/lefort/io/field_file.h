/// \file
/// Distance fields on disk (docs/reference/field-format.md).
#pragma once

#include <lefort/core/error.h>
#include <lefort/field/distance_field.h>

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

namespace lefort::io {

/// Writes a field, whatever keeps its samples, to `path`, which must end in .field.
///
/// \returns kInvalidArgument for another ending; kFileUnwritable, and `path` is as before.
[[nodiscard]] Result<void> write_field(const std::filesystem::path& path,
                                       const field::DistanceField& field);

/// Maps a file into memory and queries it there: nothing is copied but octrees and smooth lattices.
/// The file must not be changed in place while the field lives; lefort itself only replaces files.
///
/// \returns kFileNotFound; kFileUnsupported if it is no distance field or of another version;
///   kFileCorrupt if its size, checksum or contents contradict each other.
[[nodiscard]] Result<field::DistanceField> read_field(const std::filesystem::path& path);

/// The bytes of a file.
[[nodiscard]] std::string encode_field(const field::DistanceField& field);

/// \param bytes  aligned to 8 bytes; `owner` keeps them alive.
[[nodiscard]] Result<field::DistanceField> decode_field(std::span<const std::byte> bytes,
                                                        std::shared_ptr<const void> owner);

}  // namespace lefort::io
