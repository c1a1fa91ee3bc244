/// \file
/// A prediction that was stopped, in a file: what its steps found and what the next one needs.
#pragma once

#include <lefort/core/error.h>
#include <lefort/pipeline/prepare/prepare_case.h>
#include <lefort/predict/predict_face.h>

#include <filesystem>
#include <string>

namespace lefort::pipeline {

/// Hash of all that the steps of a prediction depend on: tissue, bones with their fields and paths,
/// options.
[[nodiscard]] std::string restart_key(const PreparedCase& prepared);

/// \returns nothing, or kFileUnwritable.
[[nodiscard]] Result<void> write_restart(const std::filesystem::path& path,
                                         const predict::Restart& restart);

/// \returns kFileNotFound; kFileCorrupt if the file is not as write_restart() left it.
/// \note Of this machine: numbers are written as they lie in memory.
[[nodiscard]] Result<predict::Restart> read_restart(const std::filesystem::path& path);

}  // namespace lefort::pipeline
