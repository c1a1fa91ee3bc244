/// \file
/// The directions of the arches, from arches.json.
#pragma once

#include <lefort/core/error.h>
#include <lefort/dental/measure_occlusion.h>

#include <filesystem>
#include <optional>

namespace lefort::pipeline {

/// \param arches  arches.json of register_arches().
/// \returns the directions of the upper arch, or of the lower one if it is alone there; without a
///   file those of the patient; or kFileCorrupt or an error of io::read_text().
[[nodiscard]] Result<dental::ArchAxes> read_arch_axes(
    const std::optional<std::filesystem::path>& arches);

}  // namespace lefort::pipeline
