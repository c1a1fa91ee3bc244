/// \file
/// The directions of the arches, from arches.json.
#pragma once

#include <lefort/anatomy/find_teeth.h>
#include <lefort/core/error.h>
#include <lefort/dental/measure_occlusion.h>

#include <filesystem>
#include <optional>

namespace lefort::pipeline {

struct ArchDirections {
  dental::ArchAxes axes;
  /// The jaw whose directions they are, if they are of a file.
  std::optional<anatomy::Tooth> jaw;
};

/// \param arches  arches.json of register_arches().
/// \returns the directions of the upper arch, or of the lower one if it is alone there; without a
///   file those of the patient; or kFileCorrupt or an error of io::read_text().
[[nodiscard]] Result<ArchDirections> read_arch_directions(
    const std::optional<std::filesystem::path>& arches);

/// \param arches  arches.json of register_arches() with both jaws.
/// \returns the movement of the lower arch that puts it where it is in the files of the intraoral
///   scans, relative to the upper one; or kInvalidArgument, kFileCorrupt or an error of
///   io::read_text().
[[nodiscard]] Result<RigidTransform> scanned_occlusion(const std::filesystem::path& arches);

}  // namespace lefort::pipeline
