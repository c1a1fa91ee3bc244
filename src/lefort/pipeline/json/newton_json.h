/// \file
/// What Newton tried and what contact does, as JSON: the same in every result.
#pragma once

#include <lefort/contact/contact_term.h>
#include <lefort/fem/solve/load_steps.h>

#include <nlohmann/json.hpp>

#include <vector>

namespace lefort::pipeline {

/// Every attempt with every iteration.
[[nodiscard]] nlohmann::ordered_json attempts_json(const std::vector<fem::LoadAttempt>& attempts);

[[nodiscard]] nlohmann::ordered_json contact_json(const contact::ContactStatistics& contact);

}  // namespace lefort::pipeline
