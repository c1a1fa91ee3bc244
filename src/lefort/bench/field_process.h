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
/// \returns the path of skull.vtp; errors of io::import_volume() and extract_skull();
///   kFileUnwritable.
[[nodiscard]] Result<std::filesystem::path> prepare_skull(const std::filesystem::path& ct,
                                                          const std::filesystem::path& folder,
                                                          Progress& progress);

/// Runs measure_field() in a separate process.
///
/// \param surface   file of the skull surface.
/// \param task      a FieldTask by the names of its members: `method` and `resolution` are
///   required, `exact_points` is not read, the others are optional.
/// \param progress  may stop the process.
/// \returns the result of measure_field(); kFileCorrupt if the process printed no JSON, or an error
///   of run_process().
[[nodiscard]] Result<nlohmann::ordered_json> measure_in_process(
    const std::filesystem::path& surface, const nlohmann::ordered_json& task, Progress& progress);

/// Main function of the process that measure_in_process() starts; errors of io::read_surface() and
/// measure_field(), and kInvalidArgument if the task is invalid.
[[nodiscard]] Result<nlohmann::ordered_json> run_field_task(const std::filesystem::path& surface,
                                                            const std::string& task);

}  // namespace lefort::bench
