/// \file
/// Lists of points as text.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>

#include <filesystem>
#include <string_view>
#include <vector>

namespace lefort::io {

/// Reads a point a line: x y z [mm], separated by commas, semicolons, tabs or spaces. Empty lines
/// and lines that start with # are passed over; so is a first line that starts with a letter.
///
/// \returns kFileNotFound; kFileCorrupt naming the line when it does not start with three finite
///   numbers (further columns are ignored) or there is no point at all.
[[nodiscard]] Result<std::vector<Vec3>> read_points(const std::filesystem::path& file);

/// The same from text; messages then name no file.
[[nodiscard]] Result<std::vector<Vec3>> parse_points(std::string_view text);

}  // namespace lefort::io
