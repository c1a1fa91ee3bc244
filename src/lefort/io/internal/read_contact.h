/// \file
/// Contact options, which plans and decks have in common.
#pragma once

#include <lefort/contact/distance_query.h>
#include <lefort/contact/integration.h>
#include <lefort/io/internal/validated_json.h>

#include <optional>
#include <string>

namespace lefort::io::internal {

/// Reads "detection", "integration" and "penetration_tolerance_mm" into the members of the same
/// names; a member whose key is missing keeps its value.
template <class Options>
void read_contact(const Json& json, Options& options) {
  const std::string detection = json.value("detection", std::string());
  for (const contact::DetectionMethod known :
       {contact::DetectionMethod::kSmooth, contact::DetectionMethod::kTrilinear,
        contact::DetectionMethod::kBvh})
    if (detection == contact::name_of(known)) options.detection = known;
  const std::string integration = json.value("integration", std::string());
  for (const contact::Integration known :
       {contact::Integration::kQuadrature, contact::Integration::kWeighted})
    if (integration == contact::name_of(known)) options.integration = known;
  if (const auto tolerance = json.find("penetration_tolerance_mm"); tolerance != json.end())
    options.penetration_tolerance_mm =
        tolerance->is_null() ? std::nullopt : std::optional(tolerance->get<double>());
}

}  // namespace lefort::io::internal
