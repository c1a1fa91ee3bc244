/// \file
/// Reads one file from a tar archive, with or without gzip.
#pragma once

#include <lefort/core/error.h>

#include <cstdint>
#include <string>
#include <string_view>

namespace lefort::io {

/// Reads the first regular file named `name` in any folder of the archive.
///
/// Nothing is extracted to disk.
///
/// \param archive    descriptor of a tar file; is read from its beginning.
/// \param name       file name without folder.
/// \param max_bytes  larger files are rejected.
/// \returns the bytes, or kFileCorrupt (damaged, truncated, no such entry, too large); messages do
///   not contain the name of the archive.
[[nodiscard]] Result<std::string> read_from_tar(int archive, std::string_view name,
                                                std::uint64_t max_bytes);

/// At most this many uncompressed bytes are read to find an entry; an archive in which it ends
/// later is rejected.
inline constexpr std::uint64_t kMaxUnpacked = std::uint64_t{8} << 30;

}  // namespace lefort::io
