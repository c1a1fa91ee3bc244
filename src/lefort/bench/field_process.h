/// \file
/// Measures fields in separate processes, so that memory is separate and caches are cold.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>

namespace lefort::bench {

/// Creates the folder, and skull.vtp in it from the scan unless it exists.
///
/// \returns its path; errors as import_volume() and extract_skull(); kFileUnwritable.
[[nodiscard]] Result<std::filesystem::path> prepare_skull(const std::filesystem::path& ct,
                                                          const std::filesystem::path& folder,
                                                          Progress& progress);

/// Runs measure_field() in a separate process.
///
/// \param task  a FieldTask by the names of its members; omitted members have their defaults.
/// \returns the result of measure_field().
[[nodiscard]] Result<nlohmann::ordered_json> measure_in_process(
    const std::filesystem::path& surface, const nlohmann::ordered_json& task, Progress& progress);

/// Main function of the process that measure_in_process() starts.
[[nodiscard]] Result<nlohmann::ordered_json> run_field_task(const std::filesystem::path& surface,
                                                            const std::string& task);

}  // namespace lefort::bench
