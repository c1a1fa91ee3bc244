/// \file
/// Reads one file from a tar archive, with or without gzip.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace lefort::io {

/// Reads the first regular file named `name` in any folder of the archive.
///
/// Nothing is extracted to disk. Archives of more than 8 GiB uncompressed are rejected.
///
/// \param archive    a tar file.
/// \param name       file name without folder.
/// \param max_bytes  larger files are rejected.
/// \param progress   requests to stop.
/// \returns the bytes, kFileNotFound (no such archive), kFileCorrupt (damaged, truncated, no such
///   entry, too large) or kCancelled; messages do not contain the name of the archive.
[[nodiscard]] Result<std::string> read_from_tar(const std::filesystem::path& archive,
                                                std::string_view name, std::uint64_t max_bytes,
                                                Progress& progress);

}  // namespace lefort::io
