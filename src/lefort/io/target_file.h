/// \file
/// The target of inverse planning on disk: JSON, validated against contract/target.schema.json.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/inverse/target_spec.h>

#include <filesystem>
#include <string>
#include <string_view>

namespace lefort::io {

/// A target and its text.
struct TargetText {
  inverse::TargetSpec target;
  std::string json;
};

/// Reads and checks a target with its surfaces, whose paths are relative to its folder.
///
/// \returns the target; kFileNotFound; kFileCorrupt if the file is larger than 4 MiB; kPlanInvalid
///   with the key and its error; or what read_surface() returns for a surface.
[[nodiscard]] Result<TargetText> read_target(const std::filesystem::path& file,
                                             Progress& progress = Progress::none());

/// As read_target() from text; relative paths are taken from `folder`.
[[nodiscard]] Result<inverse::TargetSpec> parse_target(std::string_view json,
                                                       const std::filesystem::path& folder,
                                                       Progress& progress = Progress::none());

}  // namespace lefort::io
