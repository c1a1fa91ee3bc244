/// \file
/// Checksums beside cached files.
#pragma once

#include <lefort/core/error.h>

#include <cstddef>
#include <filesystem>
#include <string>

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

/// Moves a complete file to a folder that other processes use at the same time. The SHA-256 gets
/// its name first, then the file, by a link: a reader finds the file with its SHA-256 or no file.
/// If another process has published an undamaged file of that name, that file stays: both were made
/// from the same inputs, and readers may have mapped it.
///
/// \param made    the file, on the file system of `target`; may be removed.
/// \param target  its name in the shared folder.
/// \returns nothing, or kFileUnwritable.
[[nodiscard]] Result<void> publish(const std::filesystem::path& made,
                                   const std::filesystem::path& target);

/// Removes the oldest files of one name in a cache, with their digests, until `kept` remain.
///
/// \param folder  of the cache.
/// \param name    ending of the file names after their key: "-tissue.vtu".
void remove_oldest(const std::filesystem::path& folder, const std::string& name, std::size_t kept);

}  // namespace lefort::pipeline
