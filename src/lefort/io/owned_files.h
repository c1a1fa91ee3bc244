/// \file
/// The files of `lefort plan check`: only what such a check has written is ever replaced.
#pragma once

#include <lefort/core/error.h>

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace lefort::io {

/// What an earlier check has written into a folder, as its check.json lists it, and check.json
/// itself; nothing if there is none.
///
/// \returns paths, or kFileUnwritable if the folder's check.json is of something else. Names that
///   no check writes are left out, whatever the list says.
[[nodiscard]] Result<std::vector<std::filesystem::path>> earlier_check_files(
    const std::filesystem::path& folder);

/// Nothing, or kInvalidArgument that names the first input which is one of `files`.
[[nodiscard]] Result<void> check_inputs_are_distinct(std::span<const std::filesystem::path> inputs,
                                                     std::span<const std::filesystem::path> files);

/// Nothing, or kFileUnwritable that names the first of `names` which is in the folder, but is none
/// of `earlier`.
[[nodiscard]] Result<void> check_none_in_the_way(const std::filesystem::path& folder,
                                                 std::span<const std::string> names,
                                                 std::span<const std::filesystem::path> earlier);

}  // namespace lefort::io
