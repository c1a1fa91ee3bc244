/// \file
/// Memory-mapped files.
#pragma once

#include <lefort/core/error.h>

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>

namespace lefort::io {

struct MappedFile {
  std::span<const std::byte> bytes;   ///< Page-aligned.
  std::shared_ptr<const void> owner;  ///< Unmaps the file when its last copy is destroyed.
};

/// Maps a file for reading.
///
/// \param path  of a regular file.
/// \returns the mapping, or kFileNotFound if it is not a readable regular file.
[[nodiscard]] Result<MappedFile> map_file(const std::filesystem::path& path);

}  // namespace lefort::io
