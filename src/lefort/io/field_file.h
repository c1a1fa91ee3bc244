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

/// Writes a field with any kind of storage.
/// \param path   must end in .field.
/// \param field  the field to write.
/// \returns nothing; kInvalidArgument for another ending; or kFileUnwritable, and an existing file
///   is unchanged.
[[nodiscard]] Result<void> write_field(const std::filesystem::path& path,
                                       const field::DistanceField& field);

/// Maps a field file into memory. Samples in bricks are used in place; all others and smooth
/// lattices are copied. The file must not be modified in place during the lifetime of the field;
/// lefort only replaces files.
///
/// \param path  a file of write_field().
/// \returns the field, in the frame B of its surface; kFileNotFound; kFileUnsupported if the file
///   is not a distance field or has another version; kFileCorrupt if its size, checksum or contents
///   are inconsistent.
[[nodiscard]] Result<field::DistanceField> read_field(const std::filesystem::path& path);

/// Returns the bytes of the file that write_field() writes.
///
/// \param field  the field to encode.
[[nodiscard]] std::string encode_field(const field::DistanceField& field);

/// Decodes the bytes of a file of write_field().
///
/// \param bytes  aligned to 8 bytes.
/// \param owner  owner of `bytes`; a field with bricks stores a copy of this pointer.
/// \returns as read_field().
[[nodiscard]] Result<field::DistanceField> decode_field(std::span<const std::byte> bytes,
                                                        std::shared_ptr<const void> owner);

}  // namespace lefort::io
