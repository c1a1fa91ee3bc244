/// \file
/// Completes the autorotations of a plan whose angles follow from the teeth.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/pipeline/prepare/load_head.h>

#include <filesystem>
#include <string>

namespace lefort::pipeline {

/// Replaces the gaps between the teeth (`gap_mm`), and the names of segments whose angle is taken
/// (`as`), by angles.
///
/// \param file  the plan, for messages and relative paths.
/// \param text  of the plan, with landmarks.
/// \param head  scan and labels, with a mandible.
/// \returns the text of the plan with angles, or
///   - kAnatomyMissing  the labels have no mandible;
///   - kPlanInvalid     `to` names the segment itself, no segment, or one without bone of the
///     skull; `as` names no segment that closes to a gap; a landmark is missing; or the teeth do
///     not meet;
///   - the errors of plan::upper_bones() and anatomy::extract_isosurface().
[[nodiscard]] Result<std::string> close_jaws(const std::filesystem::path& file, std::string text,
                                             const ScannedLabels& head, Progress& progress);

}  // namespace lefort::pipeline
