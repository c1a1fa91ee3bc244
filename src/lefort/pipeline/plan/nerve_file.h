/// \file
/// Canals of nerves as `lefort nerve` writes them.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/predict/nerve_distances.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lefort::pipeline {

struct Nerves {
  std::vector<predict::NerveTube> canals;
  std::string ct_sha256;           ///< Of the scan; empty if the file does not have it.
  std::vector<std::string> notes;  ///< What the user must know: an absent or hardly visible canal.
};

/// Reads nerve.json.
///
/// \returns the canals; or the errors of io::read_text(); or kFileCorrupt if the file is not of its
///   format, a canal has fewer than two points, or a number is not finite.
[[nodiscard]] Result<Nerves> read_nerves(const std::filesystem::path& file);

/// Reads nerve.json, if one is given, and reports its notes.
///
/// \param file       none: no canals.
/// \returns the canals; or the errors of read_nerves().
[[nodiscard]] Result<Nerves> read_given_nerves(const std::optional<std::filesystem::path>& file,
                                               Progress& progress);

/// \param ct_sha256  of the scan that is cut; empty if there is none.
/// \returns nothing; or kInvalidArgument if the canals were found in another scan, as far as both
///   are known.
[[nodiscard]] Result<void> check_same_scan(const Nerves& nerves, const std::string& ct_sha256);

}  // namespace lefort::pipeline
