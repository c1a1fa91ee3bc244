/// \file
/// Boundary conditions of the tissue and the rules that set them, as JSON.
#pragma once

#include <lefort/pipeline/prepare/prepare_case.h>

#include <nlohmann/json.hpp>

namespace lefort::pipeline {

/// Number of boundary nodes, and boundary area, set by each rule and by each painted label; the
/// interface map; and the lips.
[[nodiscard]] nlohmann::ordered_json boundary_json(const PreparedCase& prepared);

}  // namespace lefort::pipeline
