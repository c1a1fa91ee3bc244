/// \file
/// What the tissue's boundary does, and who decided it, as JSON.
#pragma once

#include <lefort/pipeline/prepare/prepare_case.h>

#include <nlohmann/json.hpp>

namespace lefort::pipeline {

/// Which rule and which painted label decided how many of the boundary's nodes, and how much of its
/// area.
[[nodiscard]] nlohmann::ordered_json boundary_json(const PreparedCase& prepared);

}  // namespace lefort::pipeline
