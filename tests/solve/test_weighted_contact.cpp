#include <lefort/contact/contact_surface.h>
#include <lefort/field/build/build_distance_field.h>
#include <lefort/geometry/bvh.h>
#include <lefort/solve/prepare_deck.h>
#include <lefort/solve/problem.h>
#include <lefort/solve/run_deck.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "solve/block.h"
#include "solve/run.h"
#include "support/box_mesh.h"
#include "support/shapes.h"

namespace lefort::solve::test_weighted_contact {
namespace {

using test::prescribe;

ObstacleDistanceQueries queries(geometry::TriangleMesh surface, double band_mm, int resolution) {
  const auto field = std::make_shared<const field::DistanceField>(
      field::build_distance_field(surface,
                                  {.resolution = resolution, .band_mm = band_mm, .smooth = true})
          .value());
  return {contact::field_distance_query(
              field, contact::DetectionMethod::kSmooth,
              std::make_shared<const geometry::TriangleMesh>(std::move(surface)))
              .value()};
}

Obstacle obstacle(std::vector<geometry::Keyframe> keyframes) {
  Obstacle obstacle;
  obstacle.name = "bone";
  obstacle.faces = "z1";
  obstacle.path = {"bone", std::move(keyframes), 1};
  obstacle.integration = contact::Integration::kWeighted;
  return obstacle;
}

void set_increments(Deck& deck, int count) {
  deck.steps.first_increment = deck.steps.max_increment = 1.0 / count;
  for (int n = 1; n < count; ++n) deck.times.push_back(double(n) / count);
}

/// Contact patch test (Taylor and Papadopoulos 1991): a flat plate on irregular faces.
class ContactPatchTest : public testing::TestWithParam<mesh::ElementShape> {};
INSTANTIATE_TEST_SUITE_P(Shapes, ContactPatchTest,
                         testing::Values(mesh::ElementShape::kTet4, mesh::ElementShape::kTet10,
                                         mesh::ElementShape::kHex8, mesh::ElementShape::kHex20));

TEST_P(ContactPatchTest, AFlatPlateLeavesAUniformState) {
  mesh::VolumeMesh mesh = test::box_mesh(
      {.cells = {3, 3, 2}, .size_mm = {9, 9, 6}, .distortion = 0.15, .shape = GetParam()});
  Deck deck;
  deck.laws.push_back({"", fem::NeoHookean::from_young_poisson(0.015, 0.3).value(), 0.0});
  deck.displacements = {prescribe("x0", 0.0, {}, {}), prescribe("y0", {}, 0.0, {}),
                        prescribe("z0", {}, {}, 0.0)};
  deck.obstacles.push_back(obstacle({{1.0, Vec3(0, 0, -1.2), Vec3::Zero(), Vec3::Zero()}}));
  set_increments(deck, 3);
  deck.newton.relative_tolerance = 1e-11;
  const DeckRun done =
      test::run(mesh, deck, queries(test::make_box({-8, -8, 6}, {18, 18, 14}), 3.0, 64));
  ASSERT_TRUE(done.completed()) << done.failure->message;
  const auto& elements = done.last->elements;
  const double first_mpa = elements.front().cauchy_mpa(2, 2);
  EXPECT_LT(first_mpa, -0.002);
  for (const fem::ElementState& element : elements) {
    EXPECT_NEAR(element.cauchy_mpa(2, 2), first_mpa, 1e-4 * std::abs(first_mpa));
    EXPECT_NEAR(element.cauchy_mpa(0, 0), 0.0, 1e-4 * std::abs(first_mpa));
  }
}

TEST(WeightedContact, ObstaclesOfOneTermHaveTheSameStiffnessAndSnapDistance) {
  const auto number_of_terms = [](double stiffness_mpa_per_mm, double contact_snap_mm) {
    Deck deck;
    deck.laws.push_back({"", fem::NeoHookean::from_young_poisson(0.015, 0.3).value(), 0.0});
    deck.displacements = {prescribe("z0", 0.0, 0.0, 0.0)};
    deck.obstacles = {obstacle({geometry::Keyframe{}}), obstacle({geometry::Keyframe{}})};
    deck.obstacles[0].stiffness_mpa_per_mm = 0.1;
    deck.obstacles[1].name = "other bone";
    deck.obstacles[1].stiffness_mpa_per_mm = stiffness_mpa_per_mm;
    deck.obstacles[1].contact_snap_mm = contact_snap_mm;
    const PreparedDeck prepared =
        prepare_deck(test::box_mesh({.cells = {2, 2, 2}, .size_mm = {9, 9, 6}}), deck).value();
    const auto query = queries(test::make_box({-8, -8, 6}, {18, 18, 14}), 3.0, 32)[0];
    const std::vector<contact::RigidObstacle> bones(2, {.distance_query_B = query});
    return make_weighted_contacts(prepared, bones).size();
  };
  const double snap_mm = Obstacle{}.contact_snap_mm;
  EXPECT_EQ(number_of_terms(0.1, snap_mm), 1U);
  EXPECT_EQ(number_of_terms(0.2, snap_mm), 2U);
  EXPECT_EQ(number_of_terms(0.1, snap_mm + 0.1), 2U);
}

geometry::RigidPath path_of(const Deck& deck) { return deck.obstacles[0].path; }

struct Pressed {
  Vec3 force_n = Vec3::Zero();
  Index iterations = 0;
};

/// Ball of 10 mm pressed 5 mm into a block, 8 mm off its middle.
Pressed press_ball(int increments) {
  Deck deck;
  deck.laws.push_back(
      {"",
       fem::DecoupledLaw<fem::MooneyRivlin>{.isochoric = {.c10_mpa = 0.005, .c01_mpa = 0.0},
                                            .volume = {.kappa_mpa = 1.0}},
       0.0});
  deck.displacements = {prescribe("z0", 0.0, 0.0, 0.0)};
  deck.obstacles.push_back(obstacle({{1.0, Vec3(0, 0, -5), Vec3::Zero(), Vec3::Zero()}}));
  deck.newton.relative_tolerance = 1e-9;
  set_increments(deck, increments);
  Pressed pressed;
  DeckWatch watch;
  watch.on_increment = [&](const Increment& increment) -> Result<void> {
    pressed.iterations += increment.newton_iterations();
    return {};
  };
  const DeckRun done =
      test::run(mesh::make_box(mesh::ElementShape::kHex8, {16, 16, 8}, Vec3(40, 40, 20)), deck,
                queries(test::make_icosphere(10.0, 5, Vec3(28, 20, 30)), 3.0, 128), watch);
  EXPECT_TRUE(done.completed()) << done.failure->message;
  pressed.force_n = done.last->contacts[0].force_L_n;
  return pressed;
}

/// Three other formulations give -2.284, -2.289 and -2.299 N. There is no history.
TEST(WeightedContact, ABallOnABlockHasTheForceOfOtherFormulationsForAnyIncrements) {
  const Pressed coarse = press_ball(5), fine = press_ball(10);
  EXPECT_NEAR(fine.force_n.z(), -2.29, 0.015);
  EXPECT_LE(fine.iterations, 5 * 10);
  EXPECT_LT((coarse.force_n - fine.force_n).norm(), 1e-7 * fine.force_n.norm());
}

geometry::TriangleMesh ridge() {
  // Its edge is shorter than the block: no sharp point passes over the border of the faces.
  geometry::TriangleMesh cube = test::make_box({-3, -3, -3}, {3, 3, 3});
  const Eigen::AngleAxisd on_edge(0.25 * std::numbers::pi, Vec3::UnitY()), turn(0.3, Vec3::UnitZ());
  for (Vec3& v : cube.vertices)
    v = turn * (on_edge * v + Vec3(0, 0, 3 * std::numbers::sqrt2)) + Vec3(5.13, 6.21, 6);
  return cube;
}

/// Deepest point of faces sampled densely, by the exact distance to the triangles.
double deepest_mm(const geometry::Bvh& bone_B, const RigidTransform& X_LB,
                  const std::vector<mesh::Face>& faces, const std::vector<Vec3>& x_L) {
  constexpr int kParts = 24;
  const RigidTransform X_BL = X_LB.inverse();
  double deepest = 0.0;
  for (const mesh::Face& face : faces)
    for (int i = 0; i <= kParts; ++i)
      for (int j = 0; j <= kParts - i; ++j) {
        const double u = double(i) / kParts, v = double(j) / kParts;
        const Vec3 p_L = (1.0 - u - v) * x_L[std::size_t(face.nodes[0])] +
                         u * x_L[std::size_t(face.nodes[1])] + v * x_L[std::size_t(face.nodes[2])];
        deepest = std::max(deepest, -bone_B.signed_distance(X_BL * p_L).distance_mm);
      }
  return deepest;
}

struct Slid {
  Vec3 force_n = Vec3::Zero();
  double deepest_mm = 0.0;   ///< Of all increments.
  double reported_mm = 0.0;  ///< The same, as reported.
};

Slid slide_ridge(int increments) {
  const mesh::VolumeMesh mesh =
      mesh::make_box(mesh::ElementShape::kTet4, {8, 8, 4}, Vec3(12, 12, 6));
  Deck deck;
  deck.laws.push_back({"", fem::NeoHookean::from_young_poisson(0.015, 0.45).value(), 0.0});
  deck.displacements = {prescribe("z0", 0.0, 0.0, 0.0)};
  deck.obstacles.push_back(obstacle({{0.5, Vec3(0, 0, -1.5), Vec3::Zero(), Vec3::Zero()},
                                     {1.0, Vec3(1.7, 0.4, -1.5), Vec3::Zero(), Vec3::Zero()}}));
  deck.newton.max_iterations = 100;
  set_increments(deck, increments);
  const geometry::Bvh bone_B(ridge());
  Slid slid;
  DeckWatch watch;
  watch.on_increment = [&](const Increment& increment) -> Result<void> {
    slid.deepest_mm = std::max(
        slid.deepest_mm,
        deepest_mm(bone_B, geometry::pose_at(path_of(deck), increment.time),
                   mesh.face_sets.at("z1"), contact::displaced(mesh.nodes_L, increment.u)));
    slid.reported_mm =
        std::max(slid.reported_mm, increment.contacts[0].max_penetration_increase_mm);
    slid.force_n = increment.contacts[0].force_L_n;
    return {};
  };
  const DeckRun done = test::run(mesh, deck, queries(ridge(), 3.0, 64), watch);
  EXPECT_TRUE(done.completed()) << done.failure->message;
  return slid;
}

TEST(WeightedContact, ASharpRidgeStaysOutsideAndItsForceDoesNotDependOnTheIncrements) {
  const Slid coarse = slide_ridge(4), fine = slide_ridge(8);
  EXPECT_LT((coarse.force_n - fine.force_n).norm(), 0.01 * fine.force_n.norm());
  EXPECT_GT(fine.force_n.norm(), 0.1);
  EXPECT_GT(coarse.force_n.norm(), 0.1);
  EXPECT_LE(coarse.deepest_mm, 0.02);
  EXPECT_LE(fine.deepest_mm, 0.02);
  EXPECT_LE(fine.reported_mm, 0.04);
  EXPECT_GE(fine.reported_mm, 0.5 * fine.deepest_mm);
}

/// Without a bound of the step the plate would be in front of the block and then behind its face.
TEST(WeightedContact, AThinPlateIsNotCrossedByALargeIncrement) {
  Deck deck;
  deck.laws.push_back({"", fem::NeoHookean::from_young_poisson(0.015, 0.3).value(), 0.0});
  deck.displacements = {prescribe("z0", 0.0, 0.0, 0.0)};
  deck.obstacles.push_back(obstacle({{1.0, Vec3(0, 0, -3), Vec3::Zero(), Vec3::Zero()}}));
  set_increments(deck, 1);
  const mesh::VolumeMesh mesh =
      mesh::make_box(mesh::ElementShape::kHex8, {4, 4, 4}, Vec3(12, 12, 12));
  const DeckRun done =
      test::run(mesh, deck, queries(test::make_box({-4, -4, 12.2}, {16, 16, 12.8}), 2.0, 128));
  ASSERT_TRUE(done.completed()) << done.failure->message;
  EXPECT_LT(done.last->contacts[0].force_L_n.z(), -0.1);
  for (const std::int32_t node : mesh.node_sets.at("z1"))
    EXPECT_LT(mesh.nodes_L[std::size_t(node)].z() + done.last->u[3 * node + 2], 9.25);
}

/// A flat square punch in the middle of a block: by symmetry no lateral force.
TEST(WeightedContact, AFlatPunchHasNoLateralForce) {
  Deck deck;
  deck.laws.push_back({"", fem::NeoHookean::from_young_poisson(0.015, 0.45).value(), 0.0});
  deck.displacements = {prescribe("z0", 0.0, 0.0, 0.0)};
  deck.obstacles.push_back(obstacle({{1.0, Vec3(0, 0, -1), Vec3::Zero(), Vec3::Zero()}}));
  set_increments(deck, 4);
  const DeckRun done =
      test::run(mesh::make_box(mesh::ElementShape::kHex8, {12, 12, 6}, Vec3(24, 24, 12)), deck,
                queries(test::make_box({8, 8, 12}, {16, 16, 18}), 3.0, 64));
  ASSERT_TRUE(done.completed()) << done.failure->message;
  const Vec3 force_n = done.last->contacts[0].force_L_n;
  EXPECT_LT(force_n.z(), -0.05);
  EXPECT_LT(force_n.head<2>().norm(), 1e-3 * std::abs(force_n.z()));
}

}  // namespace
}  // namespace lefort::solve::test_weighted_contact
