/// \file
/// Poses of the segments in the JSON document of a prediction.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace lefort::io {

/// Format version of prediction.json and failure.json.
inline constexpr int kPredictionVersion = 2;

/// Checks the format version of a prediction.
///
/// \param document  prediction.json or failure.json.
/// \returns nothing, or kFileUnsupported if the document states another version.
[[nodiscard]] Result<void> check_prediction_version(const nlohmann::json& document);

struct SegmentPose {
  std::string segment;
  RigidTransform X_LB;
};

/// Returns the poses of the segments at a step.
///
/// \param document  prediction.json or failure.json.
/// \param step      one of its `steps`.
/// \returns one pose for each segment, in the order of the plan; kFileUnsupported as
///   check_prediction_version(); kFileCorrupt if poses are missing or are not rigid motions.
[[nodiscard]] Result<std::vector<SegmentPose>> predicted_poses(const nlohmann::json& document,
                                                               const nlohmann::json& step);

}  // namespace lefort::io
