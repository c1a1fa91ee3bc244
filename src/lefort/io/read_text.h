/// \file
/// Reads a whole file, with a limit of its size.
#pragma once

#include <lefort/core/error.h>

#include <cstdint>
#include <filesystem>
#include <string>

namespace lefort::io {

/// Reads a whole file.
///
/// \param source     the file.
/// \param max_bytes  limit of its size.
/// \returns the bytes, kFileNotFound if `source` is not a readable regular file, or kFileCorrupt if
///   it is larger than `max_bytes`.
[[nodiscard]] Result<std::string> read_text(const std::filesystem::path& source,
                                            std::uintmax_t max_bytes);

}  // namespace lefort::io
