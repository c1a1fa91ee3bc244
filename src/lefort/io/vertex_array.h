/// \file
/// Numbers per vertex in a surface file.
#pragma once

#include <lefort/core/error.h>

#include <filesystem>
#include <string>
#include <vector>

namespace lefort::io {

/// Reads a scalar array of a VTP of one piece: one number per vertex of the file. These are the
/// vertices of read_surface() if every vertex has a triangle. NaN is allowed.
///
/// \param file  the surface.
/// \param name  of the array; not empty.
/// \returns the numbers, or
///   - kFileNotFound     the file does not exist;
///   - kFileCorrupt      not a VTP, truncated, or no array of this name with one number per vertex;
///   - kFileUnsupported  another byte order or compressor.
[[nodiscard]] Result<std::vector<double>> read_vertex_array(const std::filesystem::path& file,
                                                            const std::string& name);

}  // namespace lefort::io
