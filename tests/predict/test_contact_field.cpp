#include <lefort/field/build/build_distance_field.h>
#include <lefort/predict/contact_field.h>

#include <gtest/gtest.h>

#include "support/shapes.h"

namespace lefort::predict::test_contact_field {
namespace {

field::DistanceFieldOptions chosen(double bone_mm, const field::DistanceFieldOptions& options,
                                   double element_size_mm = 2.5) {
  TissueOptions tissue;
  tissue.element_size_mm = element_size_mm;
  return contact_field_options(options, test::make_icosphere(0.5 * bone_mm, 3), tissue,
                               Obstacle::kBone);
}

TEST(ContactField, BandLeavesRoomForPenetrationRestDepthAndIncrement) {
  // 3 mm, half an element, and half an increment of a quarter of an element.
  EXPECT_NEAR(chosen(60.0, {}).band_mm, 3.0 + (0.5 + 0.125) * 2.5, 1e-12);
  EXPECT_NEAR(chosen(60.0, {}, 4.0).band_mm, 3.0 + (0.5 + 0.125) * 4.0, 1e-12);
}

TEST(ContactField, AWiderDefaultBandIsKept) {
  EXPECT_EQ(chosen(60.0, {.resolution = 32}).band_mm, 0.0);  // 5 cells of 2.7 mm.
  EXPECT_GT(chosen(60.0, {.resolution = 256}).band_mm, 0.0);
}

TEST(ContactField, TheOptionsOfTheUserAreKept) {
  EXPECT_EQ(chosen(60.0, {.band_mm = 1.5}).band_mm, 1.5);
  EXPECT_EQ(chosen(60.0, {.side_mm = 90.0}).band_mm, 0.0);
}

TEST(ContactField, OfASmallBoneIsOneThatCanBeBuilt) {
  for (const double bone_mm : {1.0, 4.0, 9.0, 12.0, 40.0})
    for (const int resolution : {16, 64}) {
      const field::DistanceFieldOptions options = chosen(bone_mm, {.resolution = resolution});
      const auto field =
          field::build_distance_field(test::make_icosphere(0.5 * bone_mm, 3), options);
      ASSERT_TRUE(field) << bone_mm << " mm, " << resolution << ": " << field.error().message;
      EXPECT_GE(field->band_mm(), std::min(options.band_mm, 0.3 * bone_mm));
    }
}

}  // namespace
}  // namespace lefort::predict::test_contact_field
