/// \file
/// How contact is to be found and kept, as plans and decks say it alike.
#pragma once

#include <lefort/contact/contact_term.h>
#include <lefort/io/internal/validated_json.h>

namespace lefort::io::internal {

/// Reads "detection" (or "reconstruction", its former name), "integration" and
/// "penetration_tolerance_mm" into the members of the same names; what is not given stays.
template <class Options>
void read_contact(const Json& json, Options& options) {
  const std::string detection =
      json.value("detection", json.value("reconstruction", std::string()));
  for (const contact::DetectionMethod known :
       {contact::DetectionMethod::kSmooth, contact::DetectionMethod::kTrilinear,
        contact::DetectionMethod::kBvh})
    if (detection == contact::name_of(known)) options.detection = known;
  const std::string integration = json.value("integration", std::string());
  for (const contact::Integration known :
       {contact::Integration::kQuadrature, contact::Integration::kNodes})
    if (integration == contact::name_of(known)) options.integration = known;
  if (json.contains("penetration_tolerance_mm"))
    options.penetration_tolerance_mm = json["penetration_tolerance_mm"].get<double>();
}

}  // namespace lefort::io::internal
