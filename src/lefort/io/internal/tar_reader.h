/// \file
/// One file out of a tar archive, gzipped or not.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace lefort::io {

/// Reads the first regular file called `name`, in whatever folder of the archive.
///
/// Nothing is unpacked to disk. Archives that unpack to more than 8 GiB are refused.
///
/// \param max_bytes  larger entries of that name are refused.
/// \returns its bytes, or kFileNotFound (no such archive), kFileCorrupt (damaged, truncated, no
///   such entry, too large) or kCancelled; no message names the archive.
[[nodiscard]] Result<std::string> read_from_tar(const std::filesystem::path& archive,
                                                std::string_view name, std::uint64_t max_bytes,
                                                Progress& progress);

}  // namespace lefort::io
