#include <lefort/compare/soft_tissue_ratios.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "support/shapes.h"

namespace lefort::compare::test_soft_tissue_ratios {
namespace {

using plan::OsteotomyTemplate;

/// A head of boxes: the skin around segments and a bone behind them. -y is anterior.
struct BoxHead {
  geometry::TriangleMesh skin_L = test::make_box(Vec3::Constant(-60), Vec3::Constant(60));
  std::vector<plan::PlannedSegment> planned{};
  plan::CutSegments cut{};
  std::vector<RigidTransform> X_LB{};
  plan::Landmarks landmarks_L{};

  BoxHead() { cut.remainder_L = test::make_box({-30, 10, -30}, {30, 40, 30}); }

  /// A segment between x = `low_x` and `high_x`, whose anterior face is at y = -30.
  plan::PlannedSegment& add(const std::string& name, const RigidTransform& pose,
                            double low_x = -15.0, double high_x = 15.0) {
    plan::PlannedSegment& one = planned.emplace_back();
    one.osteotomy.segment = name;
    cut.segments_L.push_back(test::make_box({low_x, -30, -10}, {high_x, -10, 10}));
    X_LB.push_back(pose);
    return one;
  }
  [[nodiscard]] std::vector<SoftTissueRatio> ratios(
      const std::function<Vec3(const Vec3&)>& displacement) const {
    std::vector<Vec3> displacement_mm;
    for (const Vec3& p_L : skin_L.vertices) displacement_mm.push_back(displacement(p_L));
    return soft_tissue_ratios(skin_L, displacement_mm, {planned, cut, X_LB}, landmarks_L);
  }
};

RigidTransform moved_by(const Vec3& translation_mm) {
  RigidTransform pose = RigidTransform::Identity();
  pose.translation() = translation_mm;
  return pose;
}

const SoftTissueRatio* find(const std::vector<SoftTissueRatio>& ratios, const std::string& soft,
                            FaceAxis axis, const std::string& segment = {}) {
  for (const SoftTissueRatio& one : ratios)
    if (one.soft == soft && one.axis == axis && (segment.empty() || one.segment == segment))
      return &one;
  return nullptr;
}

const std::string kFacing(kFacingSkin);

TEST(SoftTissueRatios, OfAnAffineDisplacementAreExact) {
  RigidTransform pose(Eigen::AngleAxisd(0.1, Vec3(1, 0.3, 0.2).normalized()));
  pose.pretranslate(Vec3(0.5, -4.0, 6.0));
  BoxHead head;
  head.add("maxilla", pose).osteotomy.procedure = OsteotomyTemplate::kLeFort1;
  head.landmarks_L = {{"A", {1, -31, 4}}, {"Sn", {2, -61, 7}}, {"U1", {0, -30, -9}}};
  Mat3 gradient;
  gradient << 0.01, 0.02, -0.03, 0.04, 0.01, 0.02, -0.01, 0.03, 0.02;
  const Vec3 constant_mm(0.2, -2.0, 1.0);
  const auto displacement = [&](const Vec3& p_L) { return Vec3(gradient * p_L + constant_mm); };
  const auto ratios = head.ratios(displacement);

  const Vec3 soft_mm = displacement({2, -60, 7});  // Of the skin closest to the landmark.
  const Vec3 bone_mm = pose * Vec3(1, -31, 4) - Vec3(1, -31, 4);
  const SoftTissueRatio* const forward = find(ratios, "Sn", FaceAxis::kAnterior);
  ASSERT_NE(forward, nullptr);
  EXPECT_EQ(forward->hard, "A");
  EXPECT_NEAR(forward->soft_mm, -soft_mm.y(), 1e-12);
  EXPECT_NEAR(forward->hard_mm, -bone_mm.y(), 1e-12);
  EXPECT_NEAR(forward->ratio(), soft_mm.y() / bone_mm.y(), 1e-12);
  const SoftTissueRatio* const up = find(ratios, "Sn", FaceAxis::kSuperior);
  ASSERT_NE(up, nullptr);
  EXPECT_NEAR(up->ratio(), soft_mm.z() / bone_mm.z(), 1e-12);
  EXPECT_EQ(find(ratios, "Ls", FaceAxis::kAnterior), nullptr) << "the landmark is missing";

  // The mean of an affine field over the anterior face is its value at the center.
  const SoftTissueRatio* const facing = find(ratios, kFacing, FaceAxis::kAnterior);
  ASSERT_NE(facing, nullptr);
  EXPECT_NEAR(facing->soft_mm, -displacement({0, -60, 0}).y(), 1e-12);
  EXPECT_NEAR(facing->hard_mm, -(pose * Vec3(0, -30, 0) - Vec3(0, -30, 0)).y(), 1e-12);
}

TEST(SoftTissueRatios, AreRelativeToTheFrankfurtHorizontal) {
  const Mat3 tilt = Eigen::AngleAxisd(0.3, Vec3::UnitX()).toRotationMatrix();
  const Vec3 anterior_L = tilt * -Vec3::UnitY();
  const plan::Landmarks landmarks{{"Po-R", tilt * Vec3(-50, 20, 0)},
                                  {"Po-L", tilt * Vec3(50, 20, 0)},
                                  {"Or-R", tilt * Vec3(-30, -50, 0)},
                                  {"Or-L", tilt * Vec3(30, -50, 0)}};
  const FaceAxes axes = face_axes(landmarks);
  EXPECT_LT((axes.anterior_L - anterior_L).norm(), 1e-12);
  EXPECT_LT((axes.superior_L - tilt * Vec3::UnitZ()).norm(), 1e-12);
  EXPECT_LT((axes.left_L - Vec3::UnitX()).norm(), 1e-12);
  EXPECT_EQ(face_axes({}).anterior_L, Vec3(-Vec3::UnitY()));
  EXPECT_EQ(face_axes({}).superior_L, Vec3::UnitZ());
}

TEST(SoftTissueRatios, OfTheWholeMandibleAreNotThoseOfAGenioplasty) {
  BoxHead head;
  head.add("mandible", moved_by({0, 4, 0})).is_whole_mandible = true;
  head.landmarks_L = {{"Pg", {0, -30, -5}}, {"Pg'", {0, -60, -5}}};
  const auto ratios = head.ratios([](const Vec3&) { return Vec3(0, 3.8, 0); });
  const SoftTissueRatio* const chin = find(ratios, "Pg'", FaceAxis::kAnterior);
  ASSERT_NE(chin, nullptr);
  EXPECT_EQ(chin->procedure, Procedure::kSagittalSplit);
}

TEST(SoftTissueRatios, ArePositiveInASetbackWhoseSkinFollows) {
  BoxHead head;
  head.add("mandible", moved_by({0, 4, 0})).osteotomy.procedure = OsteotomyTemplate::kSagittalSplit;
  head.landmarks_L = {{"Pg", {0, -30, -5}}, {"Pg'", {0, -60, -5}}};
  const auto ratios = head.ratios([](const Vec3&) { return Vec3(0, 3.8, 0); });
  const SoftTissueRatio* const chin = find(ratios, "Pg'", FaceAxis::kAnterior);
  ASSERT_NE(chin, nullptr);
  EXPECT_EQ(chin->procedure, Procedure::kSagittalSplit);
  EXPECT_EQ(chin->direction, Direction::kSetback);
  EXPECT_TRUE(chin->is_main_axis);
  EXPECT_DOUBLE_EQ(chin->soft_mm, -3.8);
  EXPECT_DOUBLE_EQ(chin->hard_mm, -4.0);
  EXPECT_NEAR(chin->ratio(), 0.95, 1e-12);
  ASSERT_TRUE(chin->published);
  EXPECT_TRUE(chin->published->contains(chin->ratio()));
  EXPECT_EQ(find(ratios, "Pg'", FaceAxis::kSuperior), nullptr) << "no movement, no ratio";

  const auto bulging = head.ratios([](const Vec3&) { return Vec3(0, -1.0, 0); });
  const SoftTissueRatio* const wrong = find(bulging, "Pg'", FaceAxis::kAnterior);
  EXPECT_NEAR(wrong->ratio(), -0.25, 1e-12) << "the skin moves forward, the bone backward";
  EXPECT_FALSE(wrong->published->contains(wrong->ratio()));
}

TEST(SoftTissueRatios, NameTheDirectionOfImpactionAndLowering) {
  BoxHead head;
  head.add("maxilla", moved_by({0, 0.9, 3})).osteotomy.procedure = OsteotomyTemplate::kLeFort1;
  head.landmarks_L = {{"U1", {0, -30, -9}}, {"Stm", {0, -60, -12}}};
  const auto ratios = head.ratios([](const Vec3&) { return Vec3(0, 0.3, 1.2); });
  const SoftTissueRatio* const lip = find(ratios, "Stm", FaceAxis::kSuperior);
  ASSERT_NE(lip, nullptr);
  EXPECT_EQ(lip->direction, Direction::kImpaction);
  EXPECT_NEAR(lip->ratio(), 0.4, 1e-12);
  ASSERT_TRUE(lip->published);
  EXPECT_TRUE(lip->published->contains(0.4));
  EXPECT_EQ(find(ratios, "Stm", FaceAxis::kAnterior), nullptr) << "less than 1 mm";

  head.X_LB[0] = moved_by({0, 0, -2});
  const auto lowered = head.ratios([](const Vec3&) { return Vec3(0, 0, -1.0); });
  EXPECT_EQ(find(lowered, "Stm", FaceAxis::kSuperior)->direction, Direction::kLowering);
  EXPECT_NEAR(find(lowered, "Stm", FaceAxis::kSuperior)->ratio(), 0.5, 1e-12);
  EXPECT_FALSE(find(lowered, "Stm", FaceAxis::kSuperior)->published);
}

TEST(SoftTissueRatios, ListPairsWithAPublishedRangeOrTheFirst) {
  BoxHead head;
  head.add("maxilla", moved_by({0, -4, 0})).osteotomy.procedure = OsteotomyTemplate::kLeFort1;
  head.landmarks_L = {{"ANS", {0, -30, 8}}, {"A", {0, -30, 0}}, {"Sn", {0, -60, 5}}};
  const auto hard_of_sn = [&] {
    std::vector<std::string> names;
    for (const SoftTissueRatio& one : head.ratios([](const Vec3&) { return Vec3(0, -2, 0); }))
      if (one.soft == "Sn") names.push_back(one.hard);
    return names;
  };
  EXPECT_EQ(hard_of_sn(), std::vector<std::string>{"A"}) << "no study gives Sn : ANS";
  head.X_LB[0] = moved_by({0, 4, 0});
  EXPECT_EQ(hard_of_sn(), std::vector<std::string>{"A"}) << "a setback: no study, the first pair";
  head.landmarks_L.erase(head.landmarks_L.begin() + 1);
  EXPECT_EQ(hard_of_sn(), std::vector<std::string>{"ANS"});
}

TEST(SoftTissueRatios, OfTheUpperLipAreThoseOfItsLength) {
  BoxHead head;
  head.add("maxilla", moved_by({0, -2, 4})).osteotomy.procedure = OsteotomyTemplate::kLeFort1;
  head.landmarks_L = {{"U1", {0, -30, -9}}, {"Sn", {0, -60, 10}}, {"Stm", {0, -60, -10}}};
  const auto ratios = head.ratios([](const Vec3& p_L) { return Vec3(0, 0, 1 - 0.06 * p_L.z()); });
  const SoftTissueRatio* const lip = find(ratios, "Stm-Sn", FaceAxis::kSuperior);
  ASSERT_NE(lip, nullptr);
  EXPECT_NEAR(lip->ratio(), 0.3, 1e-12) << "20 mm shorter by 6 %, over 4 mm of impaction";
  ASSERT_TRUE(lip->published);
  EXPECT_TRUE(lip->published->contains(0.3));
  EXPECT_EQ(find(ratios, "Stm-Sn", FaceAxis::kAnterior), nullptr);
}

TEST(SoftTissueRatios, WithoutLandmarksAreThoseOfTheSkinAnteriorToTheSegment) {
  BoxHead head;
  head.add("front", moved_by({0, -5, -2}));
  const auto ratios = head.ratios([](const Vec3& p_L) {
    return p_L.y() < 0.0 ? Vec3(0, -4, -1) : Vec3(0, 50, 50);  // Skin behind the segment.
  });
  ASSERT_EQ(ratios.size(), 2U);
  EXPECT_EQ(ratios[0].soft, kFacing);
  EXPECT_EQ(ratios[0].hard, kSegment);
  EXPECT_EQ(ratios[0].procedure, Procedure::kUnknown);
  EXPECT_NEAR(ratios[0].ratio(), 0.8, 1e-12);
  EXPECT_FALSE(ratios[0].published) << "of an unknown procedure";
  EXPECT_EQ(ratios[1].axis, FaceAxis::kSuperior);
  EXPECT_FALSE(ratios[1].is_main_axis);
  EXPECT_NEAR(ratios[1].ratio(), 0.5, 1e-12);
}

/// The mouth: walls between teeth and lips are part of the surface, but not facing skin.
TEST(SoftTissueRatios, CrossTheWallsOfTheMouth) {
  BoxHead head;
  head.add("front", moved_by({0, -5, 0}));
  head.skin_L = test::join(head.skin_L,
                           test::turn_inside_out(test::make_box({-20, -45, -20}, {20, -40, 20})));
  const auto ratios =
      head.ratios([](const Vec3& p_L) { return p_L.y() > -50.0 ? Vec3(0, 9, 0) : Vec3(0, -3, 0); });
  ASSERT_EQ(ratios.size(), 1U);
  EXPECT_NEAR(ratios[0].ratio(), 0.6, 1e-12);
}

TEST(SoftTissueRatios, OfHiddenSurfacesAreNotMeasured) {
  BoxHead head;
  head.add("front", RigidTransform(Eigen::AngleAxisd(0.2, Vec3::UnitX())));
  head.cut.segments_L[0] = test::join(head.cut.segments_L[0],  // A plate behind the first.
                                      test::make_box({-15, -5, -10}, {15, 0, 10}));
  const auto ratios = head.ratios([](const Vec3&) { return Vec3(0, 0, -3); });
  ASSERT_FALSE(ratios.empty());
  const Vec3 center(0, -30, 0);
  EXPECT_NEAR(ratios[0].hard_mm, (head.X_LB[0] * center - center).z(), 1e-12);
}

TEST(SoftTissueRatios, KnowTheProcedureByLandmarksOrParent) {
  BoxHead head;
  head.add("by landmark", moved_by({0, -3, 0}), -15, 0);
  head.add("piece", moved_by({0, -3, 0}), 1, 15).cut_from = "by landmark";
  head.landmarks_L = {{"L1", {-5, -30, 8}}, {"Pg", {-5, -30, -8}}};
  auto ratios = head.ratios([](const Vec3&) { return Vec3(0, -3, 0); });
  EXPECT_EQ(find(ratios, kFacing, FaceAxis::kAnterior, "by landmark")->procedure,
            Procedure::kSagittalSplit);
  EXPECT_EQ(find(ratios, kFacing, FaceAxis::kAnterior, "piece")->procedure,
            Procedure::kSagittalSplit);
  head.landmarks_L = {{"Pg", {5, -30, -8}}};
  ratios = head.ratios([](const Vec3&) { return Vec3(0, -3, 0); });
  EXPECT_EQ(find(ratios, kFacing, FaceAxis::kAnterior, "piece")->procedure,
            Procedure::kGenioplasty);

  head.planned[0].osteotomy.procedure = OsteotomyTemplate::kLeFort3;
  head.planned[0].is_distracted = true;
  ratios = head.ratios([](const Vec3&) { return Vec3(0, -2.6, 0); });
  const SoftTissueRatio* const midface = find(ratios, kFacing, FaceAxis::kAnterior, "by landmark");
  EXPECT_EQ(midface->procedure, Procedure::kMidfaceDistraction);
  ASSERT_TRUE(midface->published);
  EXPECT_TRUE(midface->published->contains(midface->ratio()));
}

TEST(SoftTissueRatios, IncludeStudiesOfBothJawsIfBothMove) {
  BoxHead head;
  head.add("maxilla", moved_by({0, -4, 0}), -15, 0).osteotomy.procedure =
      OsteotomyTemplate::kLeFort1;
  head.add("mandible", moved_by({0, 4, 0}), 1, 15).osteotomy.procedure =
      OsteotomyTemplate::kSagittalSplit;
  head.landmarks_L = {{"ANS", {-5, -30, 5}}, {"Sn", {-5, -60, 5}}};
  auto ratios = head.ratios([](const Vec3&) { return Vec3(0, -3, 0); });
  ASSERT_NE(find(ratios, "Sn", FaceAxis::kAnterior), nullptr);
  EXPECT_TRUE(find(ratios, "Sn", FaceAxis::kAnterior)->published);
  head.X_LB[1] = RigidTransform::Identity();
  ratios = head.ratios([](const Vec3&) { return Vec3(0, -3, 0); });
  EXPECT_FALSE(find(ratios, "Sn", FaceAxis::kAnterior)->published) << "one jaw";
}

TEST(SoftTissueRatios, OfPartsThatMoveApartAreThoseOfExpansion) {
  BoxHead head;
  head.add("right", moved_by({-2, 0, 0}), -15, -1).osteotomy.procedure =
      OsteotomyTemplate::kLeFort1;
  head.add("left", moved_by({3, 0, 0}), 1, 15).cut_from = "right";
  head.landmarks_L = {{"Al-R", {-12, -60, 0}}, {"Al-L", {12, -60, 0}}};
  const auto ratios = head.ratios([](const Vec3& p_L) { return Vec3(0.01 * p_L.x(), 0, 0); });
  const SoftTissueRatio* const right = find(ratios, "Al-R", FaceAxis::kLateral);
  const SoftTissueRatio* const left = find(ratios, "Al-L", FaceAxis::kLateral);
  ASSERT_NE(right, nullptr);
  ASSERT_NE(left, nullptr);
  EXPECT_EQ(right->segment, "right");
  EXPECT_EQ(left->segment, "left");
  EXPECT_EQ(left->procedure, Procedure::kExpansion);
  EXPECT_EQ(left->direction, Direction::kWidening);
  EXPECT_NEAR(right->ratio(), 0.06, 1e-12);
  EXPECT_NEAR(left->ratio(), 0.04, 1e-12);
  ASSERT_TRUE(left->published);
  EXPECT_FALSE(left->published->contains(0.04));

  head.X_LB = {moved_by({3, 0, 0}), moved_by({3, 0, 0})};
  const auto shifted = head.ratios([](const Vec3&) { return Vec3(2, 0, 0); });
  EXPECT_EQ(find(shifted, kFacing, FaceAxis::kLateral)->direction, Direction::kLateral);
  EXPECT_EQ(find(shifted, "Al-L", FaceAxis::kLateral), nullptr) << "both halves to the left";
}

}  // namespace
}  // namespace lefort::compare::test_soft_tissue_ratios
