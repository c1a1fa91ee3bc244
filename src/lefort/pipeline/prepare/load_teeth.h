/// \file
/// The teeth that interface and lips of a plan use.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/io/plan_file.h>
#include <lefort/pipeline/prepare/load_head.h>
#include <lefort/predict/jaw_teeth.h>

#include <optional>

namespace lefort::pipeline {

/// Reads the tooth map of a plan, or finds the teeth in its scan, and numbers them.
///
/// \param plan  its `teeth_source` decides; the landmarks are those of the numbers.
/// \param head  of its scan.
/// \returns the teeth; nothing if the plan uses none, or with kAuto, and a note, if none are found
///   or they cannot be numbered; or
///   - kFileNotFound, kFileUnsupported, kFileCorrupt  the errors of io::read_teeth();
///   - kPlanInvalid  less than 90 % of the map is bone in the labels, so that both are not of one
///     segmentation; or the map has no numbers, and the landmarks do not suffice to find them.
[[nodiscard]] Result<std::optional<predict::JawTeeth>> load_teeth(const io::PlanFile& plan,
                                                                  const ScannedHead& head,
                                                                  Progress& progress);

}  // namespace lefort::pipeline
