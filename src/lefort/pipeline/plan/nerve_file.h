/// \file
/// Canals of nerves as `lefort nerve` writes them.
#pragma once

#include <lefort/core/error.h>
#include <lefort/predict/nerve_distances.h>

#include <filesystem>
#include <vector>

namespace lefort::pipeline {

/// Reads nerve.json.
///
/// \returns the right and the left canal; or the errors of io::read_text(); or kFileCorrupt if the
///   file is not of its format, or a number is not finite.
[[nodiscard]] Result<std::vector<predict::NerveTube>> read_nerves(
    const std::filesystem::path& file);

}  // namespace lefort::pipeline
