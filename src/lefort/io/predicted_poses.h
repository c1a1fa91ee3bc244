/// \file
/// Where a prediction's document says its segments are.
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

/// \param document  prediction.json or failure.json.
/// \param step      one of its `steps`.
/// \returns one a segment, in the order of the plan; kFileCorrupt if the document does not tell, or
///   a pose is no rigid motion.
[[nodiscard]] Result<std::vector<SegmentPose>> predicted_poses(const nlohmann::json& document,
                                                               const nlohmann::json& step);

}  // namespace lefort::io
