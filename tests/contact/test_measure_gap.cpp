#include <lefort/contact/measure_gap.h>
#include <lefort/field/build/build_distance_field.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "support/shapes.h"

namespace lefort::contact::test_measure_gap {
namespace {

using field::Zone;

constexpr double kRadius_mm = 10.0;
constexpr double kBand_mm = 3.0;

using DistanceQueryPtr = std::shared_ptr<const DistanceQuery>;

DistanceQueryPtr detect(const geometry::TriangleMesh& surface, DetectionMethod detection) {
  if (detection == DetectionMethod::kBvh)
    return bvh_distance_query(std::make_shared<const geometry::Bvh>(surface), kBand_mm);
  const field::DistanceFieldOptions options{.resolution = 64, .band_mm = kBand_mm, .smooth = true};
  return field_distance_query(std::make_shared<const field::DistanceField>(
                                  field::build_distance_field(surface, options).value()),
                              detection)
      .value();
}

DistanceQueryPtr sphere_by(DetectionMethod detection) {
  static const geometry::TriangleMesh sphere = test::make_icosphere(kRadius_mm, 5);
  static const std::array<DistanceQueryPtr, 3> all{detect(sphere, DetectionMethod::kSmooth),
                                                   detect(sphere, DetectionMethod::kTrilinear),
                                                   detect(sphere, DetectionMethod::kBvh)};
  return all[std::size_t(detection)];
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

class MeasureGap : public testing::TestWithParam<DetectionMethod> {};
INSTANTIATE_TEST_SUITE_P(All, MeasureGap,
                         testing::Values(DetectionMethod::kSmooth, DetectionMethod::kTrilinear,
                                         DetectionMethod::kBvh),
                         [](const auto& tested) { return std::string(name_of(tested.param)); });

TEST_P(MeasureGap, OfASphereIsTheDistanceToIt) {
  const RigidObstacle sphere{sphere_by(GetParam())};
  int in_band = 0;
  for (const Vec3& p_L : random_points(2000, 1)) {
    const Gap gap = measure_gap(sphere, p_L);
    const double exact_mm = p_L.norm() - kRadius_mm;
    if (gap.zone != Zone::kBand) {
      EXPECT_GT(std::abs(exact_mm), 0.95 * sphere.distance_query_B->max_distance_mm() - 0.03);
      EXPECT_EQ(gap.zone, exact_mm > 0.0 ? Zone::kOutside : Zone::kInside);
      EXPECT_NEAR(std::abs(gap.gap_mm), kBand_mm, 1e-9);
      continue;
    }
    ++in_band;
    EXPECT_NEAR(gap.gap_mm, exact_mm, 0.03);
    EXPECT_GT(gap.gradient_L.normalized().dot(p_L.normalized()), 0.995);
  }
  EXPECT_GT(in_band, 300);
}

TEST_P(MeasureGap, AMotionOfBoneAndPointsRotatesTheDerivativesOnly) {
  const RigidObstacle resting{sphere_by(GetParam())};
  RigidObstacle moved = resting;
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

TEST_P(MeasureGap, DerivativesAreThoseOfTheGap) {
  const RigidObstacle sphere{sphere_by(GetParam()), some_pose()};
  if (!sphere.distance_query_B->has_exact_derivatives()) GTEST_SKIP() << "no exact derivatives";
  constexpr double kStep = 1e-6;  // No point is closer to the face of a cell.
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

TEST_P(MeasureGap, TheHessianIsZeroWhereItIsNotComputed) {
  const RigidObstacle sphere{sphere_by(GetParam()), some_pose()};
  const Vec3 p_L = sphere.X_LB * Vec3(5.0, 5.0, 6.8);
  const Gap full = measure_gap(sphere, p_L);
  const Gap first = measure_gap(sphere, p_L, Derivatives::kFirst);
  EXPECT_EQ(first.gap_mm, full.gap_mm);
  EXPECT_EQ(first.gradient_L, full.gradient_L);
  EXPECT_EQ(full.hessian_L.norm() > 0.0, sphere.distance_query_B->has_exact_derivatives());
  EXPECT_EQ(first.hessian_L, Mat3::Zero());
}

TEST_P(MeasureGap, ManyPointsGiveTheSameBitsAsSinglePoints) {
  const RigidObstacle sphere{sphere_by(GetParam()), some_pose()};
  std::vector<Vec3> p_L = random_points(3000, 4);
  for (Vec3& p : p_L) p = sphere.X_LB * p;
  std::vector<Gap> gaps(p_L.size());
  measure_gaps(sphere, p_L, Derivatives::kSecond, gaps);
  for (std::size_t i = 0; i < p_L.size(); ++i) {
    const Gap alone = measure_gap(sphere, p_L[i]);
    ASSERT_EQ(gaps[i].zone, alone.zone);
    ASSERT_EQ(gaps[i].gap_mm, alone.gap_mm);
    ASSERT_EQ(gaps[i].gradient_L, alone.gradient_L);
    ASSERT_EQ(gaps[i].hessian_L, alone.hessian_L);
  }
}

TEST_P(MeasureGap, AllMethodsMeasureTheSameGap) {
  const RigidObstacle sphere{sphere_by(GetParam()), some_pose()};
  const RigidObstacle exact{sphere_by(DetectionMethod::kBvh), some_pose()};
  for (const Vec3& p : random_points(2000, 5)) {
    const Gap gap = measure_gap(sphere, sphere.X_LB * p, Derivatives::kFirst);
    const Gap truth = measure_gap(exact, sphere.X_LB * p, Derivatives::kFirst);
    if (gap.zone == Zone::kBand && truth.zone == Zone::kBand) {
      EXPECT_NEAR(gap.gap_mm, truth.gap_mm, 0.025);
    }
  }
}

TEST_P(MeasureGap, NonFinitePointsAndPointsFarFromAnOpenSurfaceAreUnknown) {
  const RigidObstacle sphere{sphere_by(GetParam())};
  EXPECT_TRUE(sphere.distance_query_B->is_closed());
  EXPECT_EQ(measure_gap(sphere, Vec3(0.0, std::nan(""), 0.0)).zone, Zone::kUnknown);
  const RigidObstacle sheet{detect(test::make_sheet(10.0, 4), GetParam())};
  EXPECT_FALSE(sheet.distance_query_B->is_closed());
  EXPECT_EQ(measure_gap(sheet, Vec3(0.0, 0.0, 9.0)).zone, Zone::kUnknown);
}

TEST(BvhDistanceQuery, TheNormalAtAnEdgeIsThePseudonormalOfTheEdge) {
  const RigidObstacle box{
      detect(test::make_box(Vec3::Constant(-5.0), Vec3::Constant(5.0)), DetectionMethod::kBvh)};
  const Vec3 diagonal = Vec3(1.0, 1.0, 0.0).normalized();
  for (const Vec3& p : {Vec3(6.0, 6.0, 1.0), Vec3(6.0, 5.1, 1.0)})
    EXPECT_LT((measure_gap(box, p).gradient_L - diagonal).norm(), 1e-12);
  EXPECT_EQ(measure_gap(box, {6.0, 4.9, 1.0}).gradient_L, Vec3::UnitX());
  EXPECT_NEAR(measure_gap(box, {6.0, 6.0, 1.0}).gap_mm, std::sqrt(2.0), 1e-12);
}

TEST(FieldDistanceQuery, SmoothInterpolationRequiresASmoothField) {
  const auto rough = std::make_shared<const field::DistanceField>(
      field::build_distance_field(test::make_icosphere(3.0, 2), {.resolution = 16}).value());
  EXPECT_TRUE(field_distance_query(rough, DetectionMethod::kTrilinear));
  const auto refused = field_distance_query(rough, DetectionMethod::kSmooth);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("without --smooth"), std::string::npos);
}

}  // namespace
}  // namespace lefort::contact::test_measure_gap
