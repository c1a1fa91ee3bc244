/// \file
/// A whole file as memory, without reading it.
#pragma once

#include <lefort/core/error.h>

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>

namespace lefort::io {

struct MappedFile {
  std::span<const std::byte> bytes;   ///< Aligned to a page.
  std::shared_ptr<const void> owner;  ///< Unmaps when the last copy is gone.
};

/// \returns kFileNotFound if there is no regular file that can be read.
[[nodiscard]] Result<MappedFile> map_file(const std::filesystem::path& path);

}  // namespace lefort::io
