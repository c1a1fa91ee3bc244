/// \file
/// The files of `lefort plan check`: it replaces only files that an earlier check has written.
#pragma once

#include <lefort/core/error.h>

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace lefort::io {

/// Returns the files that an earlier check has written into a folder: check.json and the files that
/// it lists. Empty if there is no check.json.
///
/// \param folder  the output folder.
/// \returns paths, or kFileUnwritable if no check wrote check.json. Listed names that a check
///   never writes are omitted.
[[nodiscard]] Result<std::vector<std::filesystem::path>> earlier_check_files(
    const std::filesystem::path& folder);

/// Checks that no input is overwritten.
///
/// \param inputs  files that are read.
/// \param files   files that will be written.
/// \returns nothing, or kInvalidArgument with the first input that is one of `files`.
[[nodiscard]] Result<void> check_inputs_are_distinct(std::span<const std::filesystem::path> inputs,
                                                     std::span<const std::filesystem::path> files);

/// Checks that only files of an earlier check are overwritten.
///
/// \param folder   the output folder.
/// \param names    files that will be written to it.
/// \param earlier  result of earlier_check_files().
/// \returns nothing, or kFileUnwritable with the first of `names` that exists and is not in
///   `earlier`.
[[nodiscard]] Result<void> check_overwrites_only_earlier(
    const std::filesystem::path& folder, std::span<const std::string> names,
    std::span<const std::filesystem::path> earlier);

}  // namespace lefort::io
