/// \file
/// Measurements of fields in processes of their own, so that memory is their own and no cache is warm.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>

namespace lefort::bench {

/// Makes the folder, and skull.vtp in it from the scan if it is not there yet.
///
/// \returns its path; errors as import_volume() and extract_skull(); kFileUnwritable.
[[nodiscard]] Result<std::filesystem::path> prepare_skull(const std::filesystem::path& ct,
                                                          const std::filesystem::path& folder,
                                                          Progress& progress);

/// \param task  a FieldTask by the names of its members; those left out have their defaults.
/// \returns what measure_field() tells.
[[nodiscard]] Result<nlohmann::ordered_json> measure_in_process(
    const std::filesystem::path& surface, const nlohmann::ordered_json& task, Progress& progress);

/// What the process started by measure_in_process() does.
[[nodiscard]] Result<nlohmann::ordered_json> run_field_task(const std::filesystem::path& surface,
                                                            const std::string& task);

}  // namespace lefort::bench
