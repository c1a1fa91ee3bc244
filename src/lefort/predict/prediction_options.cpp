#include <lefort/contact/weighted_contact_term.h>
#include <lefort/predict/prediction_options.h>

namespace lefort::predict {

double stiffness_factor(const ContactOptions& contact, const TissueOptions& tissue) {
  constexpr double kDefault = 10.0;
  if (contact.stiffness_factor) return *contact.stiffness_factor;
  if (contact.integration == contact::Integration::kWeighted)
    return contact::weighted_stiffness_mpa_per_mm(
               1.0, contact.penetration_tolerance_mm.value_or(contact::kWeightedTolerance_mm)) *
           node_spacing_mm(tissue);
  return kDefault;
}

contact::PressureLaw contact_law(const ContactOptions& contact, const TissueOptions& tissue) {
  const double penalty_mpa_per_mm =
      stiffness_factor(contact, tissue) * tissue.young_mpa / node_spacing_mm(tissue);
  if (contact.integration == contact::Integration::kWeighted || !contact.penetration_tolerance_mm)
    return {.penalty_mpa_per_mm = penalty_mpa_per_mm};
  return contact::hardening_law(penalty_mpa_per_mm, tissue.young_mpa,
                                *contact.penetration_tolerance_mm);
}

}  // namespace lefort::predict
