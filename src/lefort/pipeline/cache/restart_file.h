/// \file
/// File of a stopped prediction: its converged steps and the state for the next step.
#pragma once

#include <lefort/core/error.h>
#include <lefort/pipeline/prepare/prepare_case.h>
#include <lefort/predict/predict_face.h>

#include <filesystem>
#include <string>

namespace lefort::pipeline {

/// Hash of all inputs of the steps of a prediction: tissue, bones with their fields and paths,
/// options.
[[nodiscard]] std::string restart_key(const PreparedCase& prepared);

/// \returns nothing, or kFileUnwritable.
[[nodiscard]] Result<void> write_restart(const std::filesystem::path& path,
                                         const predict::Restart& restart);

/// \returns the state, kFileNotFound, or kFileCorrupt if the file is not one of write_restart().
/// \note Not portable: numbers have the byte order of this machine.
[[nodiscard]] Result<predict::Restart> read_restart(const std::filesystem::path& path);

}  // namespace lefort::pipeline
