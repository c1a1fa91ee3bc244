/// \file
/// Contact options, which plans and decks have in common.
#pragma once

#include <lefort/contact/contact_term.h>
#include <lefort/io/internal/validated_json.h>

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
       {contact::Integration::kQuadrature, contact::Integration::kNodes,
        contact::Integration::kWeighted})
    if (integration == contact::name_of(known)) options.integration = known;
  if (json.contains("penetration_tolerance_mm"))
    options.penetration_tolerance_mm = json["penetration_tolerance_mm"].get<double>();
}

}  // namespace lefort::io::internal
