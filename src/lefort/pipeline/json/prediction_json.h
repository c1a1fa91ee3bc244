/// \file
/// A prediction as JSON: inputs, results, and run times.
#pragma once

#include <lefort/pipeline/prepare/prepare_case.h>
#include <lefort/predict/face_prediction.h>
#include <lefort/predict/skin_displacement.h>

#include <nlohmann/json.hpp>

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lefort::pipeline {

/// Run times. All other entries are the same in every run.
struct Timing {
  std::vector<std::pair<std::string, double>> stage_seconds;
  std::vector<double> step_seconds;
};

/// The times, and the peak memory of the process so far.
[[nodiscard]] nlohmann::ordered_json timing_json(const Timing& timing);

/// \param prediction  with the steps that converged.
/// \param skin        of the last step; zero if the path did not converge.
/// \param timing      none: the key `timing` is missing.
[[nodiscard]] nlohmann::ordered_json prediction_json(
    const PreparedCase& prepared, const predict::FacePrediction& prediction,
    const predict::SkinDisplacementStatistics& skin, const std::optional<Timing>& timing);

}  // namespace lefort::pipeline
