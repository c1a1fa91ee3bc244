/// \file
/// Comparisons as JSON, CSV and words.
#pragma once

#include <lefort/app/movement_after.h>
#include <lefort/compare/compare_by_region.h>

#include <nlohmann/json.hpp>

#include <span>
#include <string>
#include <vector>

namespace lefort::app {

/// Null where a figure is none.
[[nodiscard]] nlohmann::json statistics_json(const compare::DifferenceStatistics& s);

[[nodiscard]] nlohmann::json regions_json(std::span<const compare::RegionDifference> rows);
[[nodiscard]] std::string regions_csv(std::span<const compare::RegionDifference> rows);
[[nodiscard]] std::string regions_text(std::span<const compare::RegionDifference> rows);

[[nodiscard]] nlohmann::json registration_json(const compare::Registration& registration);
[[nodiscard]] nlohmann::json movements_json(const SurgeryFound& surgery);
[[nodiscard]] std::string movements_csv(const SurgeryFound& surgery);
/// Lines, each with a line feed before it.
[[nodiscard]] std::string movements_text(const SurgeryFound& surgery);

}  // namespace lefort::app
