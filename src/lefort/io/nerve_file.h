/// \file
/// Canals of nerves as `lefort nerve` writes them.
#pragma once

#include <lefort/core/error.h>
#include <lefort/predict/nerve_distances.h>

#include <filesystem>
#include <string>
#include <vector>

namespace lefort::io {

struct Nerves {
  std::vector<predict::NerveTube> canals;
  std::string ct_sha256;           ///< Of the scan; empty if the file does not have it.
  std::vector<std::string> notes;  ///< What the user must know: an absent or hardly visible canal.
};

/// Reads nerve.json.
///
/// \returns the canals; or the errors of read_text(); or kFileCorrupt if the file is not of its
///   format, a canal has fewer than two points, or a number is not finite.
[[nodiscard]] Result<Nerves> read_nerves(const std::filesystem::path& file);

}  // namespace lefort::io
