/// \file
/// Atomic writing: an output file is complete or absent.
#pragma once

#include <lefort/core/error.h>

#include <filesystem>
#include <functional>
#include <string_view>

namespace lefort::io {

/// How the names of unfinished files begin.
inline constexpr const char* kPartialPrefix = ".partial-";

/// Calls `write` with a temporary file in the folder of `target`, then renames it to `target`.
///
/// The temporary name is unpredictable and has the ending of `target`, by which writers choose a
/// format. If `write` or the renaming fails, the temporary file is removed and an existing `target`
/// is unchanged. The bytes are on disk before the renaming.
///
/// \param target  the output file.
/// \param write   writes the temporary file.
/// \returns the error of `write`, or kFileUnwritable if the folder cannot be written, the file
///   system is full, or `write` throws. std::logic_error, which indicates a bug, is rethrown.
[[nodiscard]] Result<void> write_atomically(
    const std::filesystem::path& target,
    const std::function<Result<void>(const std::filesystem::path& temporary)>& write);

/// Writes bytes atomically.
///
/// \param target  the output file.
/// \param text    its bytes.
/// \returns as write_atomically().
[[nodiscard]] Result<void> write_text(const std::filesystem::path& target, std::string_view text);

}  // namespace lefort::io
