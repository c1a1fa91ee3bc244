/// \file
/// A prediction as JSON: what went in, what came out, what it took.
#pragma once

#include <lefort/pipeline/prepare/prepare_case.h>
#include <lefort/predict/face_prediction.h>

#include <nlohmann/json.hpp>

#include <string>
#include <utility>
#include <vector>

namespace lefort::pipeline {

/// What the run cost; kept apart, since all else is the same run after run.
struct Timing {
  std::vector<std::pair<std::string, double>> stage_seconds;
  std::vector<double> step_seconds;
};

/// Shifts of the skin, for people.
struct SkinShift {
  double max_mm = 0.0;
  double mean_over_moved_mm = 0.0;  ///< Over vertices that moved by over 0.5 mm.
};

[[nodiscard]] nlohmann::ordered_json prediction_json(const PreparedCase& prepared,
                                                     const predict::FacePrediction& prediction,
                                                     const SkinShift& skin, const Timing& timing);

}  // namespace lefort::pipeline
