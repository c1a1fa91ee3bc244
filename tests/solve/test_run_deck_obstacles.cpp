#include <lefort/core/parallel.h>
#include <lefort/field/build/build_distance_field.h>
#include <lefort/solve/run_deck.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "solve/block.h"
#include "solve/run.h"
#include "support/box_mesh.h"
#include "support/shapes.h"

namespace lefort::solve::test_run_deck_obstacles {
namespace {

using test::block;
using test::prescribe;
using test::run;
using test::sum;

constexpr double kRadius_mm = 6.0;

/// A ball that rests on the center of the block's upper side.
ObstacleDistanceQueries ball() {
  static const auto field = std::make_shared<const field::DistanceField>(
      field::build_distance_field(
          test::make_icosphere(kRadius_mm, 4, Vec3(10, 10, 10.0 + kRadius_mm)),
          {.resolution = 64, .band_mm = 2.0, .smooth = true})
          .value());
  return {contact::field_distance_query(field, contact::DetectionMethod::kSmooth).value()};
}

/// 20 x 20 x 10 mm, finer at the center of the upper side.
mesh::VolumeMesh slab() {
  mesh::VolumeMesh mesh = test::box_mesh(
      {.cells = {8, 8, 4}, .size_mm = {20, 20, 10}, .shape = mesh::ElementShape::kTet10});
  const auto drawn = [](double x, double length) {  // Towards the middle; 0 and length stay.
    const double s = 2.0 * x / length - 1.0;
    return 0.5 * length * (1.0 + s * std::abs(s) * 0.5 + s * 0.5);
  };
  for (Vec3& p : mesh.nodes_L)
    p = Vec3(drawn(p.x(), 20.0), drawn(p.y(), 20.0), 10.0 * std::pow(p.z() / 10.0, 0.7));
  return mesh;
}

Deck indentation(double depth_mm) {
  Deck deck;
  deck.laws.push_back({"", fem::NeoHookean::from_young_poisson(0.015, 0.3).value(), 0.0});
  deck.displacements = {prescribe("z0", 0.0, 0.0, 0.0)};
  Obstacle obstacle;
  obstacle.name = "ball";
  obstacle.faces = "z1";
  obstacle.path = {"ball", {{1.0, Vec3(0, 0, -depth_mm), Vec3::Zero(), Vec3::Zero()}}, 1};
  obstacle.stiffness_factor = 30.0;
  deck.obstacles.push_back(obstacle);
  return deck;
}

TEST(RunDeck, ABallPressedIntoASlabIsAboutHertz) {
  const double depth_mm = 0.8;
  const DeckRun done = run(slab(), indentation(depth_mm), ball());
  ASSERT_TRUE(done.completed()) << done.failure->message;
  const contact::ContactStatistics& contact = done.last->contacts[0];
  // A layer of height h, fixed below, is stiffer than Hertz's half-space: Dimitriadis et al.,
  // Biophys. J. 82 (2002), equation 9, chi = sqrt(R d) / h.
  const double nu = 0.3, young_mpa = 0.015;
  const double hertz_n =
      4.0 / 3.0 * young_mpa / (1.0 - nu * nu) * std::sqrt(kRadius_mm) * std::pow(depth_mm, 1.5);
  const double alpha = -(1.2876 - 1.4678 * nu + 1.3442 * nu * nu) / (1.0 - nu);
  const double chi = std::sqrt(kRadius_mm * depth_mm) / 10.0;
  const double layer = 1.0 - 2.0 * alpha * chi / std::numbers::pi +
                       4.0 * alpha * alpha * chi * chi / (std::numbers::pi * std::numbers::pi);
  EXPECT_NEAR(contact.force_L_n.z() / -(layer * hertz_n), 1.0, 0.1);
  EXPECT_LT(contact.max_penetration_mm, 0.15 * depth_mm);
  EXPECT_LT((sum(done.last->reactions_n) + contact.force_L_n).norm(), 1e-8);
  // The largest pressure is near the lowest point of the ball, and there is none elsewhere.
  const auto& touched = done.last->nodal_contacts[0];
  const mesh::VolumeMesh mesh = slab();
  double highest_mpa = 0.0;
  Vec3 at_L = Vec3::Zero();
  for (const contact::NodalContact& node : touched) {
    const Vec3& p_L = mesh.nodes_L[std::size_t(node.node)];
    if (node.pressure_mpa > highest_mpa) at_L = p_L;
    highest_mpa = std::max(highest_mpa, node.pressure_mpa);
    if ((p_L - Vec3(10, 10, 10)).norm() > 5.0) {
      EXPECT_EQ(node.pressure_mpa, 0.0);
    }
  }
  EXPECT_LT((at_L - Vec3(10, 10, 10)).norm(), 1.5);
}

TEST(RunDeck, ABallThatPassesThroughASlabIsRejected) {
  // From above to below in one increment: no contact before or after.
  Deck through = indentation(30.0);
  through.steps = {.first_increment = 1.0, .min_increment = 0.25};
  const DeckRun stopped = run(slab(), through, ball());
  EXPECT_FALSE(stopped.completed());
  ASSERT_FALSE(stopped.failed_attempts.empty());
  EXPECT_EQ(stopped.failed_attempts[0].stop, fem::NewtonStop::kRejected);
  EXPECT_NE(stopped.failed_attempts[0].reason.find("passed through obstacle ball"),
            std::string::npos)
      << stopped.failed_attempts[0].reason;
  // The same path next to the slab is free.
  Deck beside = through;
  beside.obstacles[0].path.keyframes = {{0.5, Vec3(40, 0, 0), Vec3::Zero(), Vec3::Zero()},
                                        {1.0, Vec3(40, 0, -30), Vec3::Zero(), Vec3::Zero()}};
  const DeckRun done = run(slab(), beside, ball());
  EXPECT_TRUE(done.completed()) << done.failure->message;
}

TEST(RunDeck, GivesTheSameBitsForAnyNumberOfThreads) {
  const auto with = [](int threads) {
    const ThreadLimit limit(threads);
    return run(slab(), indentation(0.5), ball());
  };
  const DeckRun one = with(1), two = with(2);
  ASSERT_TRUE(one.completed());
  EXPECT_EQ(one.last->u, two.last->u);
  EXPECT_EQ(one.last->reactions_n, two.last->reactions_n);
  EXPECT_EQ(one.last->energy_mj, two.last->energy_mj);
}

/// A plate 6 mm thick whose lower side is at `z`.
std::shared_ptr<const contact::DistanceQuery> plate_at(double z) {
  const auto field = std::make_shared<const field::DistanceField>(
      field::build_distance_field(test::make_box({-5.0, -5.0, z}, {25.0, 25.0, z + 6.0}),
                                  {.resolution = 64, .band_mm = 2.5, .smooth = true})
          .value());
  return contact::field_distance_query(field, contact::DetectionMethod::kSmooth).value();
}

Obstacle plate(const std::string& name, const std::string& faces,
               std::vector<geometry::Keyframe> keyframes) {
  Obstacle obstacle;
  obstacle.name = name;
  obstacle.faces = faces;
  obstacle.path = {name, std::move(keyframes), 1};
  obstacle.penetration_tolerance_mm = 0.005;
  return obstacle;
}

geometry::Keyframe lifted(double at, double by_mm) {
  return {.path_fraction = at, .translation_mm = {0.0, 0.0, by_mm}};
}

mesh::VolumeMesh brick() {
  return test::box_mesh(
      {.cells = {4, 4, 3}, .size_mm = {20, 20, 10}, .shape = mesh::ElementShape::kHex8});
}

TEST(RunDeck, TissueBetweenTwoBonesIsPressedEquallyByBoth) {
  Deck deck;
  deck.laws.push_back({"", fem::NeoHookean::from_young_poisson(0.015, 0.45).value(), 0.0});
  deck.displacements = {prescribe("x0", 0.0, std::nullopt, std::nullopt),
                        prescribe("y0", std::nullopt, 0.0, std::nullopt)};
  deck.obstacles = {plate("above", "z1", {lifted(1.0, -0.8)}),
                    plate("below", "z0", {lifted(1.0, 0.6)})};
  const DeckRun done = run(brick(), deck, {plate_at(10.0), plate_at(-6.0)});
  ASSERT_TRUE(done.completed()) << done.failure->message;
  const auto& contacts = done.last->contacts;
  EXPECT_LT(contacts[0].force_L_n.z(), -0.1);
  EXPECT_LT((contacts[0].force_L_n + contacts[1].force_L_n).norm(), 1e-7);
  for (const contact::ContactStatistics& contact : contacts) {
    EXPECT_NEAR(contact.area_mm2, 400.0, 1e-6);
    EXPECT_LE(contact.p99_penetration_increase_mm, 0.005);
  }
  const mesh::VolumeMesh rest = brick();
  for (const std::int32_t node : rest.node_sets.at("z1"))
    EXPECT_NEAR(done.last->u[3 * node + 2], -0.8, 0.006);
  for (const std::int32_t node : rest.node_sets.at("z0"))
    EXPECT_NEAR(done.last->u[3 * node + 2], 0.6, 0.006);
}

TEST(RunDeck, ARetreatingBoneReleasesTissue) {
  Deck deck;
  deck.laws.push_back({"", fem::NeoHookean::from_young_poisson(0.015, 0.45).value(), 0.0});
  deck.displacements = {prescribe("z0", 0.0, 0.0, 0.0)};
  deck.obstacles = {plate("above", "z1", {lifted(0.5, -1.0), lifted(1.0, 1.0)})};
  double max_n = 0.0;
  DeckWatch watch;
  watch.on_increment = [&](const Increment& increment) -> Result<void> {
    max_n = std::max(max_n, -increment.contacts[0].force_L_n.z());
    EXPECT_LE(increment.contacts[0].force_L_n.z(), 0.0) << "at " << increment.time;
    return {};
  };
  const DeckRun done = run(brick(), deck, {plate_at(10.0)}, watch);
  ASSERT_TRUE(done.completed()) << done.failure->message;
  EXPECT_GT(max_n, 0.3);
  EXPECT_EQ(done.last->contacts[0].points, 0);
  EXPECT_LT(done.last->u.lpNorm<Eigen::Infinity>(), 1e-5);
}

TEST(RunDeck, AnOpenObstacleIsRejectedByAllMethods) {
  const auto prepared = prepare_deck(slab(), indentation(0.5));
  const geometry::TriangleMesh sheet = test::make_sheet(4.0, 2);
  const auto field = std::make_shared<const field::DistanceField>(
      field::build_distance_field(sheet, {.resolution = 16, .smooth = true}).value());
  const ObstacleDistanceQueries distance_queries{
      contact::field_distance_query(field, contact::DetectionMethod::kSmooth).value(),
      contact::field_distance_query(field, contact::DetectionMethod::kTrilinear).value(),
      contact::bvh_distance_query(std::make_shared<const geometry::Bvh>(sheet), 2.0)};
  for (const auto& distance_query : distance_queries)
    EXPECT_EQ(run_deck(*prepared, {distance_query}).error().message,
              "obstacle ball is an open surface; contact needs a closed one");
}

}  // namespace
}  // namespace lefort::solve::test_run_deck_obstacles
