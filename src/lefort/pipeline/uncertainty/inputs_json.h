/// \file
/// Uncertain inputs as JSON.
#pragma once

#include <lefort/pipeline/uncertainty/uncertain_inputs.h>

#include <nlohmann/json.hpp>

#include <span>

namespace lefort::pipeline {

/// \returns `distribution` of contract/uncertain_inputs.schema.json.
[[nodiscard]] nlohmann::ordered_json as_json(const uncertainty::Distribution& distribution);

/// The text of a file of inputs, which read_inputs() reads.
[[nodiscard]] nlohmann::ordered_json as_json(std::span<const InputEntry> entries);

}  // namespace lefort::pipeline
