/// \file
/// JSON of the dental commands.
#pragma once

#include <lefort/dental/insertion_fit.h>

#include <nlohmann/json.hpp>

#include <cmath>

namespace lefort::pipeline {

/// null if the value is not finite.
[[nodiscard]] inline nlohmann::json number_or_null(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

[[nodiscard]] inline nlohmann::json fit_json(const dental::InsertionFit& fit) {
  return {{"clearance_mm",
           {{"p5", number_or_null(fit.p5_mm)},
            {"median", number_or_null(fit.median_mm)},
            {"p95", number_or_null(fit.p95_mm)}}},
          {"max_penetration_mm", fit.max_penetration_mm}};
}

}  // namespace lefort::pipeline
