/// \file
/// The files of numbered teeth and of their corrections.
#pragma once

#include <lefort/core/error.h>
#include <lefort/dental/occlusal_relations.h>
#include <lefort/dental/renumber_teeth.h>

#include <filesystem>
#include <optional>
#include <span>
#include <vector>

namespace lefort::pipeline {

/// Reads teeth_corrections.json: {"lefort_tooth_corrections": 1, "corrections": [{"found": 16,
/// "fdi": 17}]}; fdi 0 is no tooth.
///
/// \param file  none: no corrections.
/// \returns the corrections; or the errors of io::read_text(), or kFileCorrupt.
[[nodiscard]] Result<std::vector<dental::ToothCorrection>> read_tooth_corrections(
    const std::optional<std::filesystem::path>& file);

/// Writes teeth_corrections.json.
[[nodiscard]] Result<void> write_tooth_corrections(
    const std::filesystem::path& file, std::span<const dental::ToothCorrection> corrections);

/// Reads teeth.json.
///
/// \returns the crowns; or the errors of io::read_text(), or kFileCorrupt.
[[nodiscard]] Result<dental::NumberedCrowns> read_crowns(const std::filesystem::path& file);

}  // namespace lefort::pipeline
