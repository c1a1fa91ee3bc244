/// \file
/// Checksums beside cached files.
#pragma once

#include <lefort/core/error.h>

#include <filesystem>

namespace lefort::pipeline {

/// The file with the SHA-256 of `file`, as `sha256sum` writes it.
[[nodiscard]] std::filesystem::path digest_file(const std::filesystem::path& file);

/// Writes digest_file() of a complete file. Before `file` is replaced, the earlier digest must be
/// removed.
///
/// \returns nothing or kFileUnwritable.
[[nodiscard]] Result<void> write_digest(const std::filesystem::path& file);

/// \returns nothing if the bytes of `file` have the stored SHA-256; kFileNotFound if `file` or
///   digest_file() is missing; otherwise kFileCorrupt.
[[nodiscard]] Result<void> check_digest(const std::filesystem::path& file);

}  // namespace lefort::pipeline
