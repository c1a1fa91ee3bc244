#include <lefort/plan/cephalometric_norms.h>
#include <lefort/plan/cephalometrics.h>
#include <lefort/plan/head_directions.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace lefort::plan {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

TEST(HeadDirections, follow_the_frankfurt_horizontal) {
  const Mat3 tilt = Eigen::AngleAxisd(12.0 * kDegree, Vec3::UnitX()).toRotationMatrix();
  Landmarks landmarks{{"Or-R", {-33, -80, 0}},
                      {"Or-L", {33, -80, 0}},
                      {"Po-R", {-60, 5, 0}},
                      {"Po-L", {60, 5, 0}},
                      {"N", {0, -95, 30}}};
  for (Landmark& one : landmarks) one.point_L = tilt * one.point_L;
  const auto head = head_directions(landmarks);
  ASSERT_TRUE(head) << head.error().message;
  EXPECT_TRUE(head->has_frankfurt_horizontal);
  EXPECT_TRUE(head->left_L.isApprox(Vec3::UnitX(), 1e-9));
  EXPECT_TRUE(head->anterior_L.isApprox(tilt * -Vec3::UnitY(), 1e-9));
  EXPECT_TRUE(head->superior_L.isApprox(tilt * Vec3::UnitZ(), 1e-9));
  const auto unknown = head_directions({});
  ASSERT_TRUE(unknown);
  EXPECT_FALSE(unknown->has_frankfurt_horizontal);
  EXPECT_TRUE(unknown->anterior_L.isApprox(-Vec3::UnitY(), 1e-12));
}

TEST(HeadDirections, refuses_exchanged_orbitale_and_porion) {
  const Landmarks exchanged{
      {"Or-R", {-33, 5, 0}}, {"Or-L", {33, 5, 0}}, {"Po-R", {-60, -80, 0}}, {"Po-L", {60, -80, 0}}};
  ASSERT_FALSE(head_directions(exchanged));
  EXPECT_EQ(head_directions(exchanged).error().code, ErrorCode::kPlanInvalid);
  const Landmarks together{
      {"Or-R", {-33, 5, 0}}, {"Or-L", {33, 5, 0}}, {"Po-R", {-60, 8, 0}}, {"Po-L", {60, 8, 0}}};
  EXPECT_FALSE(head_directions(together));
}

RigidTransform rotation(double angle_deg, const Vec3& axis) {
  RigidTransform X = RigidTransform::Identity();
  X.linear() = Eigen::AngleAxisd(angle_deg * kDegree, axis).toRotationMatrix();
  return X;
}

TEST(MovementTerms, signs_are_those_of_the_words) {
  const HeadDirections head;  // Of the frame L.
  const Vec3 front(0.0, -90.0, 0.0), side(40.0, 0.0, 0.0);
  RigidTransform X = RigidTransform::Identity();
  X.translation() = Vec3(1.0, -5.0, 2.0);
  const MovementTerms moved = movement_terms(X, front, head);
  EXPECT_NEAR(moved.anterior_mm, 5.0, 1e-12);
  EXPECT_NEAR(moved.left_mm, 1.0, 1e-12);
  EXPECT_NEAR(moved.superior_mm, 2.0, 1e-12);
  EXPECT_NEAR(moved.yaw_deg, 0.0, 1e-12);

  const MovementTerms yaw = movement_terms(rotation(4.0, Vec3::UnitZ()), front, head);
  EXPECT_NEAR(yaw.yaw_deg, 4.0, 1e-9);
  EXPECT_GT(yaw.left_mm, 0.0);  // The front goes to the left.
  const MovementTerms pitch = movement_terms(rotation(3.0, Vec3::UnitX()), front, head);
  EXPECT_NEAR(pitch.pitch_deg, 3.0, 1e-9);
  EXPECT_LT(pitch.superior_mm, 0.0);  // The front goes down.
  const MovementTerms roll = movement_terms(rotation(2.0, -Vec3::UnitY()), side, head);
  EXPECT_NEAR(roll.roll_deg, 2.0, 1e-9);
  EXPECT_GT(roll.superior_mm, 0.0);  // The left side goes up.
}

TEST(MovementTerms, combined_rotations_are_recovered_in_order) {
  const HeadDirections head;
  const RigidTransform X =
      rotation(5.0, Vec3::UnitZ()) * rotation(-3.0, Vec3::UnitX()) * rotation(2.0, -Vec3::UnitY());
  const MovementTerms terms = movement_terms(X, Vec3::Zero(), head);
  EXPECT_NEAR(terms.yaw_deg, 5.0, 1e-9);
  EXPECT_NEAR(terms.pitch_deg, -3.0, 1e-9);
  EXPECT_NEAR(terms.roll_deg, 2.0, 1e-9);
}

TEST(CephalometricNorms, all_are_rows_of_the_table) {
  const auto rows = measure(Landmarks{}).value();
  for (const CephalometricNorm& norm : cephalometric_norms())
    EXPECT_TRUE(std::any_of(rows.begin(), rows.end(), [&](const Measurement& row) {
      return row.name == norm.measurement;
    })) << norm.measurement;
}

TEST(CephalometricNorms, lengths_of_mcnamara_are_of_life_size) {
  const auto norm_of = [](std::string_view analysis, std::string_view name) {
    for (const CephalometricNorm& norm : cephalometric_norms())
      if (norm.analysis == analysis && norm.measurement == name) return norm;
    throw std::runtime_error("no norm");
  };
  EXPECT_NEAR(norm_of("McNamara", "Co-A").female.mean, 84.26, 0.01);
  EXPECT_NEAR(norm_of("McNamara", "Co-Gn").male.mean, 124.35, 0.01);
  EXPECT_NEAR(norm_of("McNamara", "A-Nperp").male.mean, 1.02, 0.01);
  EXPECT_EQ(norm_of("McNamara", "FH-MP").female.mean, 22.7);
  EXPECT_EQ(norm_of("Steiner", "SNA").male.mean, 82.0);
}

TEST(CephalometricNorms, deviations_are_in_standard_deviations) {
  for (const CephalometricNorm& norm : cephalometric_norms()) {
    if (std::string_view(norm.analysis) == "Steiner") {
      EXPECT_FALSE(deviation_from(norm, Sex::kFemale, 85.0));
      continue;
    }
    ASSERT_TRUE(norm.male.deviation) << norm.measurement;
    EXPECT_NEAR(*deviation_from(norm, Sex::kMale, norm.male.mean + 2.0 * *norm.male.deviation), 2.0,
                1e-9);
    EXPECT_NEAR(*deviation_from(norm, Sex::kFemale, norm.female.mean), 0.0, 1e-9);
  }
}

TEST(Cephalometrics, distances_from_reference_lines) {
  // FH along -y; the vertical is z.
  const Landmarks landmarks{
      {"Or-R", {-33, -80, 0}}, {"Or-L", {33, -80, 0}},  {"Po-R", {-60, 5, 0}},
      {"Po-L", {60, 5, 0}},    {"N", {0, -90, 30}},     {"A", {0, -93, -30}},
      {"Pg", {0, -88, -90}},   {"L1", {0, -91, -55}},   {"Sn", {0, -100, -25}},
      {"Ls", {0, -104, -40}},  {"Prn", {0, -116, -15}}, {"N'", {0, -96, 32}},
      {"Me'", {0, -85, -100}}};
  const auto value = [&](const std::string& name) {
    const std::vector<Measurement> rows = measure(landmarks).value();
    for (const Measurement& row : rows)
      if (row.name == name) return row.value.value();
    throw std::runtime_error(name);
  };
  EXPECT_NEAR(value("A-Nperp"), 3.0, 1e-9);
  EXPECT_NEAR(value("Pg-Nperp"), -2.0, 1e-9);
  EXPECT_NEAR(value("A-NPg"), 4.0 * 120.0 / std::hypot(2.0, 120.0), 1e-9);
  EXPECT_NEAR(value("L1-APg"), (-91.0 + 93.0 - 5.0 * 25.0 / 60.0) * -60.0 / std::hypot(5.0, 60.0),
              1e-9);
  EXPECT_NEAR(value("Ls-TVL"), 4.0, 1e-9);
  EXPECT_NEAR(value("Prn-TVL"), 16.0, 1e-9);
  EXPECT_NEAR(value("N'-Me'"), 132.0, 1e-9);
  EXPECT_NEAR(value("Sn-Me'"), 75.0, 1e-9);
}

}  // namespace
}  // namespace lefort::plan
