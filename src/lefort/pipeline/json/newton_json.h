/// \file
/// Newton iterations, load attempts and contact statistics as JSON, the same in every result
/// (`attempt` and `contact` of contract/prediction.schema.json).
#pragma once

#include <lefort/contact/contact_statistics.h>
#include <lefort/fem/solve/load_steps.h>

#include <nlohmann/json.hpp>

#include <vector>

namespace lefort::pipeline {

/// All attempts with all iterations. `from` and `to` are fractions of a path, or times of a deck.
[[nodiscard]] nlohmann::ordered_json attempts_json(const std::vector<fem::LoadAttempt>& attempts);

/// Penetration is the depth of tissue in the bone or obstacle; its increase is measured from the
/// rest gap.
[[nodiscard]] nlohmann::ordered_json contact_json(const contact::ContactStatistics& contact);

}  // namespace lefort::pipeline
