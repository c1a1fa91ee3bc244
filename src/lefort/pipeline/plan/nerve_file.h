/// \file
/// Canals of nerves that are given to a command.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/io/nerve_file.h>

#include <filesystem>
#include <optional>
#include <string>

namespace lefort::pipeline {

/// Reads nerve.json, if one is given, and reports its notes.
///
/// \param file       none: no canals.
/// \returns the canals; or the errors of io::read_nerves().
[[nodiscard]] Result<io::Nerves> read_given_nerves(const std::optional<std::filesystem::path>& file,
                                                   Progress& progress);

/// \param ct_sha256  of the scan that is cut; empty if there is none.
/// \returns nothing; or kInvalidArgument if the canals were found in another scan, as far as both
///   are known.
[[nodiscard]] Result<void> check_same_scan(const io::Nerves& nerves, const std::string& ct_sha256);

/// Checks the canals that templates of a plan keep free, and reports their notes.
///
/// \param plan_json  text of a valid plan.
/// \param folder     of the plan.
/// \param ct_sha256  of the scan that is cut; empty if there is none.
/// \returns nothing; or the errors of io::read_nerves() and check_same_scan().
[[nodiscard]] Result<void> check_canals_of_plan(const std::string& plan_json,
                                                const std::filesystem::path& folder,
                                                const std::string& ct_sha256, Progress& progress);

}  // namespace lefort::pipeline
