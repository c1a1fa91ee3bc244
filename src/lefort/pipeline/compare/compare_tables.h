/// \file
/// Comparisons as JSON, CSV and text.
#pragma once

#include <lefort/compare/compare_by_region.h>
#include <lefort/pipeline/compare/register_after_surgery.h>

#include <nlohmann/json.hpp>

#include <span>
#include <string>
#include <vector>

namespace lefort::pipeline {

/// As JSON; values that are not finite become null.
[[nodiscard]] nlohmann::json statistics_json(const compare::DifferenceStatistics& s);

/// Regions and their differences [mm] as JSON, CSV and text.
[[nodiscard]] nlohmann::json regions_json(std::span<const compare::RegionDifference> rows);
[[nodiscard]] std::string regions_csv(std::span<const compare::RegionDifference> rows);
[[nodiscard]] std::string regions_text(std::span<const compare::RegionDifference> rows);

[[nodiscard]] nlohmann::json registration_json(const compare::Registration& registration);

/// Achieved movement of each segment [mm, degrees] as JSON and CSV.
[[nodiscard]] nlohmann::json movements_json(const SurgeryFound& surgery);
[[nodiscard]] std::string movements_csv(const SurgeryFound& surgery);
/// Achieved movements as text; each line begins with a line feed.
[[nodiscard]] std::string movements_text(const SurgeryFound& surgery);

}  // namespace lefort::pipeline
