/// \file
/// JSON of the dental commands.
#pragma once

#include <nlohmann/json.hpp>

#include <cmath>

namespace lefort::pipeline {

/// null if the value is not finite.
[[nodiscard]] inline nlohmann::json number_or_null(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

}  // namespace lefort::pipeline
