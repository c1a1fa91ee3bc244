/// \file
/// Text files of points.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>

#include <filesystem>
#include <string_view>
#include <vector>

namespace lefort::io {

/// Reads one point per line: x y z [mm], separated by commas, semicolons, tabs or spaces; further
/// columns are ignored. Empty lines, lines that start with # and a first line that starts with a
/// letter are ignored.
///
/// \param file  the table.
/// \returns the points; kFileNotFound; or kFileCorrupt if the table is empty or a line does not
///   start with three finite numbers (the message states the line).
[[nodiscard]] Result<std::vector<Vec3>> read_points(const std::filesystem::path& file);

/// As above from text; messages contain no file name.
[[nodiscard]] Result<std::vector<Vec3>> parse_points(std::string_view text);

}  // namespace lefort::io
