/// \file
/// The vestibule of jaws that are boxes: upper above the plane z = 0.1 (y + 20), mandible 2 mm
/// below it, anterior surface at y = -20.
#include <lefort/predict/oral_vestibule.h>

#include <gtest/gtest.h>

namespace lefort::predict::test_oral_vestibule {
namespace {

using anatomy::Tissue;

constexpr double kFront_mm = -20.0, kSlope = 0.1, kGap_mm = 2.0, kDepth_mm = 10.0;

/// \param bite_mm  the mandible is this far below the plane.
anatomy::LabelMap jaws(double bite_mm = kGap_mm) {
  anatomy::LabelMap labels;
  labels.grid.size = {81, 91, 91};
  labels.grid.origin_L = {-40.0, -30.0, -45.0};
  for (Index k = 0; k < 91; ++k)
    for (Index j = 0; j < 91; ++j)
      for (Index i = 0; i < 81; ++i) {
        const Vec3 p_L = labels.grid.point_L({double(i), double(j), double(k)});
        const double height_mm = p_L.z() - kSlope * (p_L.y() - kFront_mm);
        const bool is_jaw = std::abs(p_L.x()) <= 30.0 && p_L.y() >= kFront_mm && p_L.y() <= 30.0;
        Tissue tissue = Tissue::kSoftTissue;
        if (is_jaw && height_mm >= 0.0) tissue = Tissue::kBone;
        if (is_jaw && height_mm <= -bite_mm && height_mm > -32.0) tissue = Tissue::kMandible;
        labels.values.push_back(tissue);
      }
  return labels;
}

/// A point on the anterior or lateral surface of a jaw, at a height along z above the plane.
Vec3 at(double y_mm, double height_mm) {
  return {30.0, y_mm, kSlope * (y_mm - kFront_mm) + height_mm};
}

TEST(OralVestibule, ReachesFromTheEdgesByCrownAndDepthAlongTheOcclusalPlane) {
  const auto vestibule = find_oral_vestibule(jaws(), kDepth_mm);
  ASSERT_TRUE(vestibule.has_value());
  EXPECT_NEAR(vestibule->normal_L.y() / vestibule->normal_L.z(), -kSlope, 0.02);
  EXPECT_NEAR(vestibule->normal_L.x(), 0.0, 0.02);
  constexpr double kUpper_mm = kUpperCrown_mm + kDepth_mm;
  constexpr double kLower_mm = kGap_mm + kLowerCrown_mm + kDepth_mm;
  constexpr double kVoxels_mm = 2.5;  // Edges are those of voxels of 1 mm; the plane is tilted.
  for (const double y_mm : {kFront_mm, 0.0, 20.0}) {
    EXPECT_TRUE(vestibule->contains(at(y_mm, kUpper_mm - kVoxels_mm), false)) << y_mm;
    EXPECT_FALSE(vestibule->contains(at(y_mm, kUpper_mm + kVoxels_mm), false)) << y_mm;
    EXPECT_TRUE(vestibule->contains(at(y_mm, -kLower_mm + kVoxels_mm), true)) << y_mm;
    EXPECT_FALSE(vestibule->contains(at(y_mm, -kLower_mm - kVoxels_mm), true)) << y_mm;
  }
  EXPECT_FALSE(vestibule->contains(at(kFront_mm + 50.0, 5.0), false));  // Behind the arches.
  // Bone far below the upper jaw, such as the hyoid, and a coronoid process are not in it.
  EXPECT_FALSE(vestibule->contains(at(0.0, -40.0), false));
  EXPECT_FALSE(vestibule->contains(at(0.0, 20.0), true));
  EXPECT_FALSE(vestibule->contains({40.0, 0.0, 5.0}, false));  // Lateral to them.
}

TEST(OralVestibule, FollowsEachJawInAnOpenBite) {
  const auto closed = find_oral_vestibule(jaws(), kDepth_mm);
  const auto open = find_oral_vestibule(jaws(10.0), kDepth_mm);
  ASSERT_TRUE(closed && open);
  EXPECT_NEAR(open->upper_fold_mm, closed->upper_fold_mm, 1.0);
  EXPECT_NEAR(open->lower_fold_mm, closed->lower_fold_mm - 8.0, 1.0);
}

TEST(OralVestibule, IsNotFoundWithoutAMandible) {
  anatomy::LabelMap labels = jaws();
  for (Tissue& tissue : labels.values)
    if (tissue == Tissue::kMandible) tissue = Tissue::kSoftTissue;
  EXPECT_FALSE(find_oral_vestibule(labels, kDepth_mm).has_value());
}

}  // namespace
}  // namespace lefort::predict::test_oral_vestibule
