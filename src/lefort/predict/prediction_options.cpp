#include <lefort/contact/weighted_contact_term.h>
#include <lefort/predict/prediction_options.h>

namespace lefort::predict {

double stiffness_factor(const ContactOptions& contact, const TissueOptions& tissue) {
  constexpr double kRegularized = 100.0, kByPenalty = 10.0, kByMultipliers = 160.0;
  if (contact.stiffness_factor) return *contact.stiffness_factor;
  if (contact.integration == contact::Integration::kWeighted)
    return contact::weighted_stiffness_mpa_per_mm(
               1.0, contact.penetration_tolerance_mm.value_or(contact::kWeightedTolerance_mm)) *
           node_spacing_mm(tissue);
  if (contact.penetration_tolerance_mm) return kByMultipliers;
  return contact.obstacle == Obstacle::kRegularized ? kRegularized : kByPenalty;
}

}  // namespace lefort::predict
