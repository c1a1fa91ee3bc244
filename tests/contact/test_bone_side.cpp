#include <lefort/contact/bone_side.h>

#include <gtest/gtest.h>

namespace lefort::contact {
namespace {

/// Sides are told from what was measured alone: no bone is asked.
const BoneObstacle kBone{};

Gap gap(double gap_mm, const Vec3& gradient) {
  return {.zone = field::Zone::kBand, .gap_mm = gap_mm, .gradient_L = gradient};
}

/// From 0.2 mm above a bone whose upper side is z = 0.
Sight from_above() { return look(kBone, {0.0, 0.0, 0.2}, gap(0.2, Vec3::UnitZ())); }

TEST(BoneSide, TheWallIsThePlaneThatTouchedTheBone) {
  const Sight sight = from_above();
  EXPECT_EQ(sight.foot_B, Vec3::Zero());
  const Gap wall = gap_to_wall(kBone, {3.0, 0.0, -1.5}, sight);
  EXPECT_EQ(wall.gap_mm, -1.5);
  EXPECT_EQ(wall.gradient_L, Vec3::UnitZ());
  EXPECT_EQ(wall.hessian_L, Mat3::Zero());
}

TEST(BoneSide, TheWallMovesWithTheBone) {
  BoneObstacle bone;
  bone.X_LB = Eigen::Translation3d(1.0, 2.0, 3.0) * Eigen::AngleAxisd(0.7, Vec3(1, 2, 2) / 3.0);
  const Vec3 p_B(0.4, -0.3, -0.6);
  const Sight sight =
      look(bone, bone.X_LB * Vec3(0.0, 0.0, 0.2), gap(0.2, bone.X_LB.linear() * Vec3::UnitZ()));
  const Gap wall = gap_to_wall(bone, bone.X_LB * p_B, sight);
  EXPECT_NEAR(wall.gap_mm, -0.6, 1e-12);
  EXPECT_LT((wall.gradient_L - bone.X_LB.linear() * Vec3::UnitZ()).norm(), 1e-12);
}

TEST(BoneSide, PastTheMiddleOfAPlateTheFarSideIsNearer) {
  // 2 mm thick.
  EXPECT_FALSE(is_past_middle(kBone, {0, 0, -0.9}, gap(-0.9, Vec3::UnitZ()), from_above()));
  EXPECT_TRUE(is_past_middle(kBone, {0, 0, -1.1}, gap(-0.9, -Vec3::UnitZ()), from_above()));
}

TEST(BoneSide, InARidgeTheFlanksAreNearerThanTheTip) {
  EXPECT_TRUE(is_past_middle(kBone, {0.1, 0, -1.0}, gap(-0.4, Vec3::UnitX()), from_above()));
}

TEST(BoneSide, InACornerAnotherWallMayTakeOver) {
  // On the floor z = 0 the point has come into a wall that looks along -x.
  EXPECT_FALSE(is_past_middle(kBone, {0.3, 0, 0.1}, gap(-0.3, -Vec3::UnitX()), from_above()));
  EXPECT_FALSE(is_past_middle(kBone, {0.3, 0, -0.1}, gap(-0.3, -Vec3::UnitX()), from_above()));
}

TEST(BoneSide, OffTheBoneNormalsTurnFreely) {
  EXPECT_FALSE(is_past_middle(kBone, {9, 0, -1.0}, gap(0.1, Vec3::UnitX()), from_above()));
}

TEST(BoneSide, APointFromBeyondTheBandHasNoSide) {
  const Sight far = look(kBone, {0, 0, 9}, {.zone = field::Zone::kOutside, .gap_mm = 5.0});
  EXPECT_FALSE(far.has_wall());
  EXPECT_TRUE(far.knows_side);
  EXPECT_FALSE(is_past_middle(kBone, {0, 0, -1.1}, gap(-0.9, -Vec3::UnitZ()), far));
}

TEST(BoneSide, ASideIsSeenAgainWhereTheNearestSurfaceLooksAsItDid) {
  EXPECT_TRUE(sees_its_side(kBone, {0, 0, -0.5}, gap(-0.5, Vec3(0, 0.6, 0.8)), from_above()));
  EXPECT_FALSE(sees_its_side(kBone, {0, 0, -0.9}, gap(-0.5, Vec3(0, 0.8, 0.6)), from_above()));
}

TEST(BoneSide, APointThatSlidOffAnEdgeSeesItsSideButNotOnePushedThrough) {
  EXPECT_TRUE(sees_its_side(kBone, {1.1, 0, -0.5}, gap(0.1, Vec3::UnitX()), from_above()));
  EXPECT_FALSE(sees_its_side(kBone, {0, 0, -2.1}, gap(0.1, -Vec3::UnitZ()), from_above()));
}

}  // namespace
}  // namespace lefort::contact
