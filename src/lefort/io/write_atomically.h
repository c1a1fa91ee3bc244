/// \file
/// Outputs appear whole or not at all.
#pragma once

#include <lefort/core/error.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace lefort::io {

/// Lets `write` fill a temporary file beside `target`, then renames it to `target`.
///
/// The temporary name ends like `target`, because writers choose a format by the ending, and cannot
/// be foreseen. When `write` or the renaming fails, the temporary file is removed and an older
/// `target` stays. The bytes are on the disk before `target` has its name.
///
/// \returns what `write` returned, or kFileUnwritable when the folder cannot be written or the file
///   system is full; an exception of a library in `write` counts as kFileUnwritable. Bugs
///   (std::logic_error, which LogicError is) are thrown on.
[[nodiscard]] Result<void> write_atomically(
    const std::filesystem::path& target,
    const std::function<Result<void>(const std::filesystem::path& temporary)>& write);

/// Writes these bytes, whole or not at all.
[[nodiscard]] Result<void> write_text(const std::filesystem::path& target, std::string_view text);

/// Reads a whole file; kFileNotFound, or kFileCorrupt when larger than `max_bytes`.
[[nodiscard]] Result<std::string> read_text(const std::filesystem::path& source,
                                            std::uintmax_t max_bytes);

}  // namespace lefort::io
