#include <lefort/inverse/observe_face.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "support/shapes.h"

namespace lefort::inverse::test_observe_face {
namespace {

constexpr double kRadius_mm = 40.0;

geometry::TriangleMesh head() { return test::make_icosphere(kRadius_mm, 4); }

/// A smooth displacement without symmetry.
std::vector<Vec3> displaced(const geometry::TriangleMesh& skin) {
  std::vector<Vec3> u;
  for (const Vec3& p : skin.vertices)
    u.push_back(Vec3(0.5 * std::sin(0.05 * p.z()), -2.0 + 0.02 * p.x(), 0.3 + 0.01 * p.y()));
  return u;
}

Result<FaceObserver> observer_of(FaceTarget target, char is_moved = 1) {
  geometry::TriangleMesh skin = head();
  const std::vector<char> moved(skin.vertices.size(), is_moved);
  return FaceObserver::create(std::move(skin), moved, std::move(target));
}

FaceTarget all_kinds() {
  FaceTarget target;
  target.landmarks = {{.name = "P", .point_L = Vec3(3, -39, 5), .to_L = Vec3(2, -45, 7)},
                      {.name = "D",
                       .point_L = Vec3(-8, -38, -9),
                       .to_L = Vec3(-8, -41, -9),
                       .direction_L = -Vec3::UnitY(),
                       .weight = 2.0}};
  target.profiles = {{.name = "profile",
                      .x_mm = 1.0,
                      .points = {{-12.3, -45.0}, {0.2, -41.0}, {14.1, -40.0}},
                      .weight = 3.0}};
  geometry::TriangleMesh wanted = test::make_icosphere(kRadius_mm + 1.5, 4);
  for (Vec3& v : wanted.vertices) v += Vec3(0.2, -0.4, 0.1);
  target.surfaces = {{.name = "surface",
                      .surface_L = std::move(wanted),
                      .region_L = Box3(Vec3(-30, -50, -30), Vec3(30, -10, 30)),
                      .weight = 0.5}};
  return target;
}

TEST(ObserveFace, DerivativesAreCentralDifferences) {
  const FaceObserver observer = observer_of(all_kinds()).value();
  const std::vector<Vec3> u = displaced(observer.skin_L());
  const std::vector<Observation> at = observer.observe(u);
  ASSERT_GT(at.size(), 100U);
  // In one direction of all vertices.
  std::vector<Vec3> du;
  for (std::size_t v = 0; v < u.size(); ++v)
    du.push_back(Vec3(std::sin(0.01 * double(v)), std::cos(0.013 * double(v)), 0.4));
  constexpr double kStep = 1e-6;
  std::vector<Vec3> low = u, high = u;
  for (std::size_t v = 0; v < u.size(); ++v) {
    low[v] -= kStep * du[v];
    high[v] += kStep * du[v];
  }
  const auto before = observer.observe(low), after = observer.observe(high);
  ASSERT_EQ(before.size(), at.size());
  ASSERT_EQ(after.size(), at.size());
  double slope = 0.0;
  for (std::size_t i = 0; i < at.size(); ++i) {
    double derivative = 0.0;
    for (std::size_t k = 0; k < 3; ++k)
      derivative += at[i].gradient[k].dot(du[std::size_t(at[i].vertices[k])]);
    const double difference = (after[i].residual_mm - before[i].residual_mm) / (2.0 * kStep);
    EXPECT_NEAR(derivative, difference, 1e-4) << i << " of target " << at[i].target;
    slope += at[i].weight * at[i].residual_mm * derivative;
  }
  EXPECT_NEAR(slope, (objective_mm2(after) - objective_mm2(before)) / (2.0 * kStep),
              1e-5 * std::abs(slope));
}

TEST(ObserveFace, ResidualsAreDistancesInClosedForm) {
  const FaceObserver observer = observer_of(all_kinds()).value();
  const geometry::TriangleMesh& skin = observer.skin_L();
  const std::vector<Vec3> rest(skin.vertices.size(), Vec3::Zero());
  const auto at = observer.observe(rest);
  const auto residuals = residuals_by_target(at, 4);
  // The chords of the sphere lie inside it by at most 0.1 mm.
  const Vec3 on_sphere = kRadius_mm * Vec3(3, -39, 5).normalized();
  EXPECT_NEAR(residuals[0].rms_mm, (on_sphere - Vec3(2, -45, 7)).norm(), 0.1);
  EXPECT_EQ(residuals[0].count, 1);
  EXPECT_EQ(residuals[2].count, 3);
  const double y = -std::sqrt(kRadius_mm * kRadius_mm - 12.3 * 12.3 - 1.0);
  const auto first =
      std::find_if(at.begin(), at.end(), [](const auto& o) { return o.target == 2; });
  EXPECT_NEAR(first->residual_mm, y + 45.0, 0.1);
  EXPECT_NEAR(residuals[3].rms_mm, 1.5, 0.6);
  const auto profile = observer.profile_y_mm(rest, 1.0, std::vector<double>{-12.3, 100.0});
  EXPECT_NEAR(*profile[0], y, 0.1);
  EXPECT_FALSE(profile[1]);
}

TEST(ObserveFace, TheWeightOfATargetDoesNotDependOnItsNumberOfPoints) {
  FaceTarget few = all_kinds();
  few.landmarks.clear();
  few.surfaces.clear();
  FaceTarget many = few;
  many.profiles[0].points.insert(many.profiles[0].points.end(), few.profiles[0].points.begin(),
                                 few.profiles[0].points.end());
  const FaceObserver a = observer_of(few).value(), b = observer_of(many).value();
  const std::vector<Vec3> u = displaced(a.skin_L());
  EXPECT_NEAR(objective_mm2(a.observe(u)), objective_mm2(b.observe(u)), 1e-12);
}

TEST(ObserveFace, TheObjectiveDoesNotFallWhereSkinLeavesATarget) {
  const FaceObserver observer = observer_of(all_kinds()).value();
  const geometry::TriangleMesh& skin = observer.skin_L();
  const std::vector<Vec3> near(skin.vertices.size(), Vec3::Zero());
  const std::vector<Vec3> far(skin.vertices.size(), Vec3(200, 0, 0));
  const auto at_rest = observer.observe(near), away = observer.observe(far);
  ASSERT_EQ(at_rest.size(), away.size());
  const auto residuals = residuals_by_target(away, 4);
  EXPECT_DOUBLE_EQ(residuals[2].rms_mm, FaceObserver::kMaxMotion_mm);  // No skin on the rays.
  EXPECT_NEAR(residuals[3].rms_mm, SurfaceTarget{}.max_distance_mm, 1e-9);
  for (std::size_t i = 0; i < away.size(); ++i)
    EXPECT_TRUE(away[i].target < 2 || away[i].gradient[0].norm() == 0.0) << i;
  EXPECT_GT(objective_mm2(away), objective_mm2(at_rest));
}

TEST(ObserveFace, TheBorderOfAnOpenSurfaceDoesNotAttract) {
  FaceTarget target;
  geometry::TriangleMesh front = test::make_icosphere(kRadius_mm + 2.0, 4);
  std::erase_if(front.triangles, [&](const geometry::Triangle& t) {
    return std::any_of(t.begin(), t.end(),
                       [&](std::int32_t v) { return front.vertices[std::size_t(v)].y() > -8.0; });
  });
  target.surfaces = {{.name = "front",
                      .surface_L = front,
                      .region_L = Box3(Vec3(-45, -45, -45), Vec3(45, 0, 45))}};
  const FaceObserver observer = observer_of(target).value();
  const auto at =
      observer.observe(std::vector<Vec3>(observer.skin_L().vertices.size(), Vec3::Zero()));
  // Between the front and the region's end at y = 0 the closest point is the border.
  double fraction = 0.0;
  for (const Observation& one : at) {
    EXPECT_LT(one.at_L.y(), -5.0);
    EXPECT_NEAR(one.residual_mm, -2.0, 0.1);
    fraction += one.fraction;
  }
  EXPECT_NEAR(fraction, 1.0, 1e-12);
}

TEST(ObserveFace, ATargetOfWeightZeroIsMeasured) {
  FaceTarget target = all_kinds();
  target.landmarks[1].weight = 0.0;
  const FaceObserver observer = observer_of(target).value(),
                     weighted = observer_of(all_kinds()).value();
  const std::vector<Vec3> u = displaced(observer.skin_L());
  const auto rms = [&](const FaceObserver& by) {
    return residuals_by_target(by.observe(u), 4)[1].rms_mm;
  };
  EXPECT_GT(rms(observer), 0.5);
  EXPECT_DOUBLE_EQ(rms(observer), rms(weighted));
}

TEST(ObserveFace, TargetsThatDoNotFitThePatientAreErrors) {
  const auto error_of = [](FaceTarget target, char is_moved = 1) {
    const auto observer = observer_of(std::move(target), is_moved);
    return observer ? std::string() : observer.error().message;
  };
  FaceTarget target;
  EXPECT_EQ(error_of(target), "no target has a positive weight");
  target.landmarks = {{.name = "P", .point_L = Vec3(0, -80, 0), .to_L = Vec3(0, -84, 0)}};
  EXPECT_EQ(error_of(target), "landmark P lies more than 10 mm from the skin");
  target.landmarks[0] = {.name = "P", .point_L = Vec3(0, -40, 0), .to_L = Vec3(0, -1040, 0)};
  EXPECT_EQ(error_of(target), "landmark P would move by 1000 mm; at most 50 mm are possible");
  target.landmarks[0].to_L = Vec3(0, -44, 0);
  EXPECT_EQ(error_of(target, 0),
            "landmark P lies outside the meshed tissue, which no segment moves there");
  target.landmarks.clear();
  target.profiles = {{.name = "lips", .x_mm = 0.0, .points = {{90.0, -40.0}}}};
  EXPECT_EQ(error_of(target),
            "profile lips: there is no skin at the height 90 mm in the plane x = 0 mm");
  target.profiles.clear();
  geometry::TriangleMesh other = head();
  for (Vec3& v : other.vertices) v += Vec3(300, 0, 0);
  target.surfaces = {{.name = "other", .surface_L = other}};
  EXPECT_EQ(error_of(target),
            "surface other is close to 0 % of the skin in its region only: is it of another "
            "patient or in another frame? At least 50 % must lie within 15 mm of it");
  target.surfaces[0].region_L = Box3(Vec3::Constant(500), Vec3::Constant(600));
  EXPECT_EQ(error_of(target), "surface other: no skin that a segment can move lies in its region");
}

}  // namespace
}  // namespace lefort::inverse::test_observe_face
