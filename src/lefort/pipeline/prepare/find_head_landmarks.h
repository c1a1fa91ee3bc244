/// \file
/// Landmarks of a segmented scan, and plans whose landmarks are found automatically.
#pragma once

#include <lefort/anatomy/label_map.h>
#include <lefort/anatomy/tissue_levels.h>
#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/io/plan_file.h>
#include <lefort/pipeline/cache/stage_cache.h>
#include <lefort/plan/find_landmarks.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lefort::pipeline {

/// Extracts the surfaces of skull, mandible and skin, and finds the landmarks on them.
///
/// \param labels  on the grid of `ct`.
/// \returns the landmarks; kMeshInvalid without bone of the skull or without skin; or the errors of
///   plan::find_landmarks().
[[nodiscard]] Result<plan::LandmarkSearch> find_head_landmarks(const image::CtVolume& ct,
                                                               const anatomy::LabelMap& labels,
                                                               const anatomy::LevelOptions& levels,
                                                               Progress& progress);

/// "found automatically, standard uncertainty 1.2 mm", for each landmark.
[[nodiscard]] std::vector<std::string> remarks_of(const plan::LandmarkSearch& search);

/// A line that names the landmarks, with their uncertainties, and those that are missing.
[[nodiscard]] std::string describe(const plan::LandmarkSearch& search);

/// Reads a plan. If its landmarks are "auto", they are found in its scan, reported, and replace
/// "auto" in the text that is returned.
///
/// \param file   the plan.
/// \param ct     instead of the plan's.
/// \param cache  for the labels.
/// \returns as io::read_plan_text(); or the errors of io::scan_of(), scan_labels() and
///   find_head_landmarks().
[[nodiscard]] Result<io::PlanText> read_plan_of_scan(const std::filesystem::path& file,
                                                     const std::optional<std::filesystem::path>& ct,
                                                     const StageCache& cache, Progress& progress);

}  // namespace lefort::pipeline
