/// \file
/// Numbers that a surface file holds beside its vertices.
#pragma once

#include <lefort/core/error.h>

#include <filesystem>
#include <string>
#include <vector>

namespace lefort::io {

/// Reads one scalar array of a VTP of one piece: a number per vertex as the file has them, which
/// are those of read_surface() where every vertex has a triangle. NaN is a number here.
///
/// \param name  not empty.
///
/// \returns the numbers, or
///   - kFileNotFound  there is no such file;
///   - kFileCorrupt   it is no VTP, is cut short, or holds no array of that name with one number
///     per vertex.
[[nodiscard]] Result<std::vector<double>> read_vertex_array(const std::filesystem::path& file,
                                                            const std::string& name);

}  // namespace lefort::io
