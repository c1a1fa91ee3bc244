// The contact pressure of a prediction, from the options of the plan.
#include <lefort/predict/prediction_options.h>

#include <gtest/gtest.h>

namespace lefort::predict::test_contact_law {
namespace {

TissueOptions tissue() {
  TissueOptions tissue;
  tissue.young_mpa = 0.02;
  return tissue;
}

TEST(ContactLaw, HasAPenaltyOfTenTimesYoungsModulusOverTheNodeSpacingAndAHardeningTerm) {
  const contact::PressureLaw law = contact_law({}, tissue());
  EXPECT_DOUBLE_EQ(law.penalty_mpa_per_mm, 10.0 * 0.02 / node_spacing_mm(tissue()));
  EXPECT_DOUBLE_EQ(law.hardening_mpa_per_mm2, 4.0 * 0.02 / (0.05 * 0.05));
  EXPECT_DOUBLE_EQ(law.linear_beyond_mm, 0.1);
}

TEST(ContactLaw, TheNodeSpacingIsThatOfTheElementOrder) {
  TissueOptions second = tissue();
  second.element_order = 2;
  EXPECT_DOUBLE_EQ(contact_law({}, second).penalty_mpa_per_mm,
                   2.0 * contact_law({}, tissue()).penalty_mpa_per_mm);
}

TEST(ContactLaw, WithoutAToleranceIsThePenaltyOfThePaper) {
  const contact::PressureLaw law =
      contact_law({.stiffness_factor = 30.0, .penetration_tolerance_mm = std::nullopt}, tissue());
  EXPECT_DOUBLE_EQ(law.penalty_mpa_per_mm, 30.0 * 0.02 / node_spacing_mm(tissue()));
  EXPECT_EQ(law.hardening_mpa_per_mm2, 0.0);
}

TEST(ContactLaw, OfWeightedGapsHasAPenaltyInverselyProportionalToTheTolerance) {
  const auto penalty = [](double tolerance_mm) {
    const contact::PressureLaw law = contact_law(
        {.integration = contact::Integration::kWeighted, .penetration_tolerance_mm = tolerance_mm},
        tissue());
    EXPECT_EQ(law.hardening_mpa_per_mm2, 0.0);
    return law.penalty_mpa_per_mm;
  };
  EXPECT_DOUBLE_EQ(penalty(0.05), 2.0 * penalty(0.1));
}

}  // namespace
}  // namespace lefort::predict::test_contact_law
