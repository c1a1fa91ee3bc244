#include <lefort/contact/thin_bone_contact.h>

#include <gtest/gtest.h>

namespace lefort::contact::test_thin_bone_contact {
namespace {

/// The functions use the pose alone; no distance query is needed.
const RigidObstacle kBone{};

Gap gap(double gap_mm, const Vec3& gradient) {
  return {.zone = field::Zone::kBand, .gap_mm = gap_mm, .gradient_L = gradient};
}

/// Reference of a point 0.2 mm above a bone with its upper face at z = 0.
ContactReference from_above() {
  return contact_reference(kBone, {0.0, 0.0, 0.2}, gap(0.2, Vec3::UnitZ()));
}

TEST(ThinBoneContact, TheTangentPlaneTouchesTheBoneAtTheReferencePoint) {
  const ContactReference reference = from_above();
  EXPECT_EQ(reference.foot_B, Vec3::Zero());
  const Gap tangent_plane = gap_to_tangent_plane(kBone, {3.0, 0.0, -1.5}, reference);
  EXPECT_EQ(tangent_plane.gap_mm, -1.5);
  EXPECT_EQ(tangent_plane.gradient_L, Vec3::UnitZ());
  EXPECT_EQ(tangent_plane.hessian_L, Mat3::Zero());
}

TEST(ThinBoneContact, TheTangentPlaneMovesWithTheBone) {
  RigidObstacle bone;
  bone.X_LB = Eigen::Translation3d(1.0, 2.0, 3.0) * Eigen::AngleAxisd(0.7, Vec3(1, 2, 2) / 3.0);
  const Vec3 p_B(0.4, -0.3, -0.6);
  const ContactReference reference = contact_reference(
      bone, bone.X_LB * Vec3(0.0, 0.0, 0.2), gap(0.2, bone.X_LB.linear() * Vec3::UnitZ()));
  const Gap tangent_plane = gap_to_tangent_plane(bone, bone.X_LB * p_B, reference);
  EXPECT_NEAR(tangent_plane.gap_mm, -0.6, 1e-12);
  EXPECT_LT((tangent_plane.gradient_L - bone.X_LB.linear() * Vec3::UnitZ()).norm(), 1e-12);
}

TEST(ThinBoneContact, CrossesTheMedialSurfaceOfAPlate) {
  // 2 mm thick.
  EXPECT_FALSE(
      has_crossed_medial_surface(kBone, {0, 0, -0.9}, gap(-0.9, Vec3::UnitZ()), from_above()));
  EXPECT_TRUE(
      has_crossed_medial_surface(kBone, {0, 0, -1.1}, gap(-0.9, -Vec3::UnitZ()), from_above()));
}

TEST(ThinBoneContact, CrossesTheMedialSurfaceOfARidge) {
  EXPECT_TRUE(
      has_crossed_medial_surface(kBone, {0.1, 0, -1.0}, gap(-0.4, Vec3::UnitX()), from_above()));
}

TEST(ThinBoneContact, AConcaveCornerHasNoMedialSurface) {
  // The point on the floor z = 0 has entered a wall with normal -x.
  EXPECT_FALSE(
      has_crossed_medial_surface(kBone, {0.3, 0, 0.1}, gap(-0.3, -Vec3::UnitX()), from_above()));
  EXPECT_FALSE(
      has_crossed_medial_surface(kBone, {0.3, 0, -0.1}, gap(-0.3, -Vec3::UnitX()), from_above()));
}

TEST(ThinBoneContact, TheFarSideDiffersByMoreThan120DegreesInsideTheBone) {
  EXPECT_TRUE(is_at_far_side(kBone, gap(-0.1, -Vec3::UnitZ()), from_above()));
  EXPECT_TRUE(is_at_far_side(kBone, gap(-0.1, Vec3(0, 0.8, -0.6)), from_above()));
  EXPECT_FALSE(is_at_far_side(kBone, gap(-0.1, Vec3(0, 0.9, -0.43)), from_above()));
  EXPECT_FALSE(is_at_far_side(kBone, gap(0.1, -Vec3::UnitZ()), from_above()));
}

TEST(ThinBoneContact, OutsideTheBoneNothingIsCrossed) {
  EXPECT_FALSE(
      has_crossed_medial_surface(kBone, {9, 0, -1.0}, gap(0.1, Vec3::UnitX()), from_above()));
}

TEST(ThinBoneContact, APointFromBeyondTheBandHasNoTangentPlane) {
  const ContactReference far =
      contact_reference(kBone, {0, 0, 9}, {.zone = field::Zone::kOutside, .gap_mm = 5.0});
  EXPECT_FALSE(far.has_tangent_plane());
  EXPECT_TRUE(far.is_side_known);
  EXPECT_FALSE(has_crossed_medial_surface(kBone, {0, 0, -1.1}, gap(-0.9, -Vec3::UnitZ()), far));
}

TEST(ThinBoneContact, ReturnsWhereTheClosestNormalIsTheReferenceNormal) {
  EXPECT_TRUE(has_returned(kBone, {0, 0, -0.5}, gap(-0.5, Vec3(0, 0.6, 0.8)), from_above()));
  EXPECT_FALSE(has_returned(kBone, {0, 0, -0.9}, gap(-0.5, Vec3(0, 0.8, 0.6)), from_above()));
}

TEST(ThinBoneContact, APointThatSlidOffAnEdgeHasReturnedButNotOnePushedThrough) {
  EXPECT_TRUE(has_returned(kBone, {1.1, 0, -0.5}, gap(0.1, Vec3::UnitX()), from_above()));
  EXPECT_FALSE(has_returned(kBone, {0, 0, -2.1}, gap(0.1, -Vec3::UnitZ()), from_above()));
}

}  // namespace
}  // namespace lefort::contact::test_thin_bone_contact
