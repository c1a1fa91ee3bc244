/// \file
/// Where results go.
#pragma once

#include <lefort/core/error.h>

#include <filesystem>

namespace lefort::app {

/// Makes sure that a folder is there and can be written, before hours of work depend on it.
///
/// \returns nothing, or kFileUnwritable. A folder that could not be used is not left behind.
[[nodiscard]] Result<void> make_output_folder(const std::filesystem::path& folder);

}  // namespace lefort::app
