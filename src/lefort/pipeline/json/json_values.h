/// \file
/// Points, poses and fragments as JSON, the same in all results and responses.
#pragma once

#include <lefort/core/types.h>
#include <lefort/plan/fragments.h>

#include <nlohmann/json.hpp>

#include <vector>

namespace lefort::pipeline {

/// x, y, z.
[[nodiscard]] nlohmann::json as_json(const Vec3& v);

/// The 16 numbers of the 4 by 4 matrix, row by row; translation in mm.
[[nodiscard]] nlohmann::json as_json(const RigidTransform& pose);

/// Volume, position and owner of each fragment of one osteotomy.
[[nodiscard]] nlohmann::json as_json(const std::vector<plan::Fragment>& fragments);

}  // namespace lefort::pipeline
