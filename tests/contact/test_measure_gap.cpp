#include <lefort/contact/measure_gap.h>
#include <lefort/field/build_distance_field.h>

#include <gtest/gtest.h>

#include <memory>
#include <random>

#include "support/shapes.h"

namespace lefort::contact {
namespace {

using field::Zone;

constexpr double kRadius_mm = 10.0;
constexpr double kBand_mm = 3.0;

std::shared_ptr<const field::DistanceField> sphere_field() {
  static const auto shared = std::make_shared<const field::DistanceField>(
      field::build_distance_field(test::make_icosphere(kRadius_mm, 5),
                                  {.resolution = 64, .band_mm = kBand_mm, .smooth = true})
          .value());
  return shared;
}

std::vector<Vec3> random_points(int count, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> coordinate(-13.0, 13.0);
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i)
    points.emplace_back(coordinate(generator), coordinate(generator), coordinate(generator));
  return points;
}

RigidTransform some_pose() {
  RigidTransform X_LB = RigidTransform::Identity();
  X_LB.linear() = Eigen::AngleAxisd(0.7, Vec3(1.0, 2.0, -0.5).normalized()).toRotationMatrix();
  X_LB.translation() = Vec3(4.0, -7.0, 2.5);
  return X_LB;
}

class MeasureGap : public testing::TestWithParam<Reconstruction> {};
INSTANTIATE_TEST_SUITE_P(Both, MeasureGap,
                         testing::Values(Reconstruction::kTrilinear, Reconstruction::kSmooth));

TEST_P(MeasureGap, OfASphereIsTheDistanceToIt) {
  const BoneObstacle sphere{sphere_field(), RigidTransform::Identity(), GetParam()};
  int in_band = 0;
  for (const Vec3& p_L : random_points(2000, 1)) {
    const Gap gap = measure_gap(sphere, p_L);
    const double exact_mm = p_L.norm() - kRadius_mm;
    if (gap.zone != Zone::kBand) {
      // Between samples trilinear interpolation needs all eight; the spline reaches further.
      const double told_mm =
          GetParam() == Reconstruction::kSmooth ? 0.95 * kBand_mm : sphere_field()->told_mm();
      EXPECT_GT(std::abs(exact_mm), told_mm - 0.03);
      EXPECT_EQ(gap.zone, exact_mm > 0.0 ? Zone::kOutside : Zone::kInside);
      continue;
    }
    ++in_band;
    EXPECT_NEAR(gap.gap_mm, exact_mm, 0.03);
    EXPECT_GT(gap.gradient_L.normalized().dot(p_L.normalized()), 0.995);
  }
  EXPECT_GT(in_band, 300);
}

TEST_P(MeasureGap, MovingBoneAndPointsTogetherTurnsNormalsAndNothingElse) {
  const BoneObstacle resting{sphere_field(), RigidTransform::Identity(), GetParam()};
  BoneObstacle moved = resting;
  moved.X_LB = some_pose();
  for (const Vec3& p : random_points(500, 2)) {
    const Gap before = measure_gap(resting, p);
    const Gap after = measure_gap(moved, moved.X_LB * p);
    ASSERT_EQ(before.zone, after.zone);
    EXPECT_NEAR(before.gap_mm, after.gap_mm, 1e-9);
    const Mat3 R = moved.X_LB.linear();
    EXPECT_LT((R * before.gradient_L - after.gradient_L).norm(), 1e-7);
    EXPECT_LT((R * before.hessian_L * R.transpose() - after.hessian_L).norm(), 1e-6);
  }
}

TEST_P(MeasureGap, DerivativesAreThoseOfTheGapInThePatientsFrame) {
  const BoneObstacle sphere{sphere_field(), some_pose(), GetParam()};
  constexpr double kStep = 1e-6;  // No point lies so near to the face of a cell.
  int compared = 0;
  for (const Vec3& p : random_points(300, 3)) {
    const Vec3 p_L = sphere.X_LB * p;
    const Gap gap = measure_gap(sphere, p_L);
    if (gap.zone != Zone::kBand || std::abs(gap.gap_mm) > 0.9 * kBand_mm) continue;
    ++compared;
    for (int axis = 0; axis < 3; ++axis) {
      const Gap plus = measure_gap(sphere, p_L + kStep * Vec3::Unit(axis));
      const Gap minus = measure_gap(sphere, p_L - kStep * Vec3::Unit(axis));
      EXPECT_NEAR(gap.gradient_L[axis], (plus.gap_mm - minus.gap_mm) / (2.0 * kStep), 1e-6);
      const Vec3 column = (plus.gradient_L - minus.gradient_L) / (2.0 * kStep);
      EXPECT_LT((gap.hessian_L.col(axis) - column).norm(), 1e-4);
    }
  }
  EXPECT_GT(compared, 30);
}

TEST_P(MeasureGap, TheSecondDerivativeIsLeftOutWhereItIsNotAskedFor) {
  const BoneObstacle sphere{sphere_field(), some_pose(), GetParam()};
  const Vec3 p_L = sphere.X_LB * Vec3(5.0, 5.0, 6.8);
  const Gap full = measure_gap(sphere, p_L);
  const Gap first = measure_gap(sphere, p_L, Derivatives::kFirst);
  EXPECT_EQ(first.gap_mm, full.gap_mm);
  EXPECT_EQ(first.gradient_L, full.gradient_L);
  EXPECT_GT(full.hessian_L.norm(), 0.0);
  EXPECT_EQ(first.hessian_L, Mat3::Zero());
}

}  // namespace
}  // namespace lefort::contact
