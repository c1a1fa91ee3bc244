/// \file
/// Poses of the segments in the JSON document of a prediction.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace lefort::io {

struct SegmentPose {
  std::string segment;
  RigidTransform X_LB;
};

/// Returns the poses of the segments at a step.
///
/// \param document  prediction.json or failure.json.
/// \param step      one of its `steps`.
/// \returns one pose per segment, in the order of the plan; or kFileCorrupt if the document does
///   not contain them or a pose is not a rigid motion.
[[nodiscard]] Result<std::vector<SegmentPose>> predicted_poses(const nlohmann::json& document,
                                                               const nlohmann::json& step);

}  // namespace lefort::io
