/// \file
/// Points and poses as JSON, the same in all results and responses.
#pragma once

#include <lefort/core/types.h>

#include <nlohmann/json.hpp>

namespace lefort::pipeline {

[[nodiscard]] nlohmann::json as_json(const Vec3& v);

/// The rows of a 4 by 4 matrix, 16 numbers.
[[nodiscard]] nlohmann::json as_json(const RigidTransform& pose);

}  // namespace lefort::pipeline
