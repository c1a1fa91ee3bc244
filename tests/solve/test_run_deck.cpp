#include <lefort/core/parallel.h>
#include <lefort/field/build/build_distance_field.h>
#include <lefort/solve/run_deck.h>

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "solve/block.h"
#include "support/shapes.h"

namespace lefort::solve {
namespace {

using test::block;
using test::kBlockLaw;
using test::prescribe;

DeckRun run(mesh::VolumeMesh mesh, Deck deck, const ObstacleDistanceQueries& distance_queries = {},
            const DeckWatch& watch = {}, Progress& progress = Progress::none()) {
  const auto prepared = prepare_deck(std::move(mesh), std::move(deck));
  EXPECT_TRUE(prepared) << prepared.error().message;
  auto done = run_deck(*prepared, distance_queries, watch, progress);
  EXPECT_TRUE(done) << done.error().message;
  return *std::move(done);
}

Vec3 sum(const std::vector<Vec3>& vectors) {
  Vec3 total = Vec3::Zero();
  for (const Vec3& vector : vectors) total += vector;
  return total;
}

/// Transverse stretch without transverse stress, by bisection.
double transverse_stretch(double axial) {
  double low = 0.5, high = 1.5;
  for (int n = 0; n < 100; ++n) {
    const double s = 0.5 * (low + high);
    const Mat3 F = Vec3(s, s, axial).asDiagonal();
    (kBlockLaw.stress(F)(0, 0) < 0.0 ? low : high) = s;
  }
  return low;
}

class RunDeckOn : public testing::TestWithParam<mesh::ElementShape> {};
INSTANTIATE_TEST_SUITE_P(Shapes, RunDeckOn,
                         testing::Values(mesh::ElementShape::kTet4, mesh::ElementShape::kPyramid5,
                                         mesh::ElementShape::kWedge6, mesh::ElementShape::kHex8,
                                         mesh::ElementShape::kTet10, mesh::ElementShape::kWedge15,
                                         mesh::ElementShape::kHex20),
                         [](const auto& tested) { return std::string(name_of(tested.param)); });

TEST_P(RunDeckOn, UniaxialStretchIsTheClosedForm) {
  Deck deck = test::uniaxial_deck(8.0);
  deck.probes = {{"corner", Vec3(10, 10, 20)}, {"middle", Vec3(5, 5, 10)}};
  const DeckRun done = run(block(GetParam()), deck);
  ASSERT_TRUE(done.completed()) << done.failure->message;
  const Increment& last = *done.last;
  EXPECT_EQ(last.time, 1.0);
  const double axial = 1.4, across = transverse_stretch(axial);
  const Mat3 F = Vec3(across, across, axial).asDiagonal();
  EXPECT_NEAR(last.reactions_n[3].z(), 100.0 * kBlockLaw.stress(F)(2, 2), 1e-7);
  EXPECT_NEAR(last.reactions_n[2].z(), -last.reactions_n[3].z(), 1e-9);
  EXPECT_NEAR(last.probes_mm[0].x(), 10.0 * (across - 1.0), 1e-6);
  EXPECT_LT((last.probes_mm[1] - Vec3(5.0 * (across - 1.0), 5.0 * (across - 1.0), 4.0)).norm(),
            1e-6);
  EXPECT_NEAR(last.energy_mj, 2000.0 * kBlockLaw.energy(F), 1e-6);
  EXPECT_NEAR(last.min_J, across * across * axial, 1e-7);
  for (const fem::ElementState& element : last.elements) {
    EXPECT_LT((element.stretches - Vec3(axial, across, across)).norm(), 1e-6);
    EXPECT_LT((element.cauchy_mpa - fem::cauchy_stress(kBlockLaw.stress(F), F)).norm(), 1e-8);
  }
}

TEST_P(RunDeckOn, ReactionsCarryTheDeadLoads) {
  Deck deck = test::clamped_deck();
  deck.laws[0].density_t_per_mm3 = 1e-9;
  deck.body_forces.push_back({"", Vec3(0, 3000, -9810), {}});
  deck.tractions.push_back({"z1", Vec3(2e-4, 0, 1e-4), {}});
  const DeckRun done = run(block(GetParam()), deck);
  ASSERT_TRUE(done.completed()) << done.failure->message;
  // 2000 mm^3 of 1e-9 t/mm^3, and 100 mm^2.
  EXPECT_LT((done.last->loads_n[0] - Vec3(0.02, 0, 0.01)).norm(), 1e-12);
  EXPECT_LT((done.last->loads_n[1] - Vec3(0, 0.006, -0.01962)).norm(), 1e-12);
  EXPECT_LT((sum(done.last->reactions_n) + sum(done.last->loads_n)).norm(), 1e-9);
  EXPECT_GT(done.last->max_displacement_mm, 0.05);
}

TEST_P(RunDeckOn, AFollowerPressureRotatesWithItsFace) {
  Deck deck = test::clamped_deck();
  deck.pressures.push_back({"x0", 5e-4, {}});
  const DeckRun done = run(block(GetParam()), deck);
  ASSERT_TRUE(done.completed()) << done.failure->message;
  const Vec3 load_n = done.last->loads_n[0];
  EXPECT_NEAR(load_n.x(), 5e-4 * 200.0, 0.03);
  EXPECT_LT(load_n.z(), -1e-3);  // The side is inclined: the pressure has a component along -z.
  EXPECT_LT((sum(done.last->reactions_n) + load_n).norm(), 1e-8);
}

TEST(RunDeck, ATwistedBlockFollowsItsUpperSideAndNeedsHalving) {
  Deck deck = test::clamped_deck();
  RigidlyMovedSet lid;
  lid.set = "z1";
  lid.path = {"lid", {{1.0, Vec3::Zero(), Vec3(0, 0, 2.4), Vec3(5, 5, 0)}}, 1};
  deck.motions.push_back(lid);
  deck.steps.first_increment = 1.0;
  std::vector<double> times;
  DeckWatch watch;
  int failures = 0;
  watch.on_increment = [&](const Increment& increment) -> Result<void> {
    times.push_back(increment.time);
    EXPECT_EQ(increment.number, int(times.size()));
    EXPECT_TRUE(increment.attempts.back().stop == fem::NewtonStop::kConverged);
    failures += int(increment.attempts.size()) - 1;
    return {};
  };
  const DeckRun done = run(block(), deck, {}, watch);
  ASSERT_TRUE(done.completed()) << done.failure->message;
  EXPECT_GT(failures, 0);
  EXPECT_TRUE(std::is_sorted(times.begin(), times.end()));
  EXPECT_EQ(times.back(), 1.0);
  EXPECT_LT(sum(done.last->reactions_n).norm(), 1e-8);
  const auto corner = std::int32_t(block().node_sets.at("z1").front());
  const Vec3 X_L = block().nodes_L[std::size_t(corner)];
  const Vec3 turned =
      Vec3(5, 5, 20) + Eigen::AngleAxisd(2.4, Vec3::UnitZ()) * (X_L - Vec3(5, 5, 20));
  EXPECT_LT((done.last->u.segment<3>(3 * Index(corner)) - (turned - X_L)).norm(), 1e-12);
}

TEST(RunDeck, AFailedCompressionKeepsItsLastState) {
  const DeckRun done = run(block(), test::uniaxial_deck(-25.0));
  ASSERT_FALSE(done.completed());
  EXPECT_EQ(done.failure->code, ErrorCode::kNotConverged);
  ASSERT_TRUE(done.last);
  EXPECT_GT(done.last->time, 0.5);
  EXPECT_LT(done.last->time, 0.8);
  EXPECT_FALSE(done.failed_attempts.empty());
  EXPECT_NE(done.failure->message.find("no equilibrium from load level"), std::string::npos);
  EXPECT_NE(done.failure->message.find("smallest J: element "), std::string::npos)
      << done.failure->message;
}

TEST(RunDeck, ADeadLoadConvergesUpToItsLimitPoint) {
  // In uniaxial strain s the law has P = (lambda + 2 mu)/2 (s^3 - s), with its minimum at 1/sqrt 3.
  // With a larger lambda, shear loses stability first.
  const fem::StVenantKirchhoff law{.mu_mpa = 0.01, .lambda_mpa = 0.0};
  const double max_mpa = (law.lambda_mpa + 2.0 * law.mu_mpa) / (3.0 * std::sqrt(3.0));
  Deck deck;
  deck.laws.push_back({"", law, 0.0});
  deck.sets.push_back({"all", NodesOfRegion{"0"}});
  deck.displacements = {prescribe("all", 0.0, 0.0, {}), prescribe("z0", {}, {}, 0.0)};
  deck.tractions.push_back({"z1", Vec3(0, 0, -2.0 * max_mpa), {}});
  DeckWatch watch;
  std::string reported_first;
  watch.on_failure = [&](const DeckRun& failed) -> Result<void> {
    reported_first = failed.failure->message;
    EXPECT_FALSE(failed.failed_attempts.empty());
    return {};
  };
  const DeckRun done = run(block(), deck, {}, watch);
  ASSERT_FALSE(done.completed());
  EXPECT_TRUE(done.failure->message.starts_with(reported_first + "; ")) << reported_first;
  EXPECT_NE(reported_first.find("no equilibrium"), std::string::npos);
  // The last state that converged lies before the limit point.
  EXPECT_NE(done.failure->message.find("the tangent is positive definite"), std::string::npos)
      << done.failure->message;
  EXPECT_EQ(done.failure->code, ErrorCode::kNotConverged);
  ASSERT_TRUE(done.last);
  EXPECT_GT(done.last->time, 0.49);
  EXPECT_LE(done.last->time, 0.5);
  EXPECT_NE(done.failure->message.find("limit point"), std::string::npos) << done.failure->message;
}

TEST(RunDeck, ALargeBodyIsNotFactorizedForADiagnosis) {
  Deck deck;
  deck.laws.push_back({"", fem::StVenantKirchhoff{.mu_mpa = 0.01, .lambda_mpa = 0.0}, 0.0});
  deck.sets.push_back({"all", NodesOfRegion{"0"}});
  deck.displacements = {prescribe("all", 0.0, 0.0, {}), prescribe("z0", {}, {}, 0.0)};
  deck.tractions.push_back({"z1", Vec3(0, 0, -0.01), {}});
  const auto message = [&](Index direct_rows) {
    deck.linear_solver.direct_rows = direct_rows;
    const DeckRun done = run(block(), deck);
    return done.completed() ? std::string("completed") : done.failure->message;
  };
  EXPECT_NE(message(60000).find("not positive definite"), std::string::npos) << message(60000);
  EXPECT_NE(message(10).find("smallest J: element"), std::string::npos) << message(10);
}

TEST(RunDeck, APressureOnAFreeBoundaryIsNotDiagnosedAsLimitPoint) {
  Deck deck = test::clamped_deck();
  deck.pressures.push_back({"x0", 0.1, {}});
  const DeckRun done = run(block(), deck);
  ASSERT_FALSE(done.completed());
  EXPECT_EQ(done.failure->message.find("limit point"), std::string::npos) << done.failure->message;
  EXPECT_NE(done.failure->message.find("a pressure on faces with a free boundary"),
            std::string::npos)
      << done.failure->message;
}

TEST(RunDeck, APartConnectedByOneEdgeIsDiagnosed) {
  // Two boxes that share the edge from (1, 0, 1) to (1, 1, 1): the second one rotates about it.
  mesh::VolumeMesh mesh = test::box_mesh({.cells = {1, 1, 1}});
  const mesh::VolumeMesh other = mesh;
  std::vector<std::int32_t> number;
  for (const Vec3& p : other.nodes_L) {
    const Vec3 shifted = p + Vec3(1, 0, 1);
    const auto same = std::find_if(mesh.nodes_L.begin(), mesh.nodes_L.begin() + 8,
                                   [&](const Vec3& q) { return (q - shifted).norm() < 1e-9; });
    number.push_back(same < mesh.nodes_L.begin() + 8 ? std::int32_t(same - mesh.nodes_L.begin())
                                                     : std::int32_t(mesh.nodes_L.size()));
    if (number.back() == std::int32_t(mesh.nodes_L.size())) mesh.nodes_L.push_back(shifted);
  }
  for (const std::int32_t node : other.blocks[0].nodes)
    mesh.blocks[0].nodes.push_back(number[std::size_t(node)]);
  mesh.blocks[0].region.resize(12, 0);
  Deck deck = test::clamped_deck();
  deck.sets.push_back({"tip", NodeNearest{Vec3(2, 0, 2)}});
  deck.laws[0].density_t_per_mm3 = 1e-9;
  deck.body_forces.push_back({"", Vec3(0, 0, -9810), {}});
  const DeckRun done = run(mesh, deck);
  ASSERT_FALSE(done.completed());
  EXPECT_FALSE(done.last);
  EXPECT_NE(done.failure->message.find("connected only by a node or an edge"), std::string::npos)
      << done.failure->message;
}

class StopAfter final : public Progress {
 public:
  void report(double fraction) override { stop_ = fraction > 0.3; }
  [[nodiscard]] bool stop_requested() const override { return stop_; }

 private:
  bool stop_ = false;
};

TEST(RunDeck, StopsOnRequestAndKeepsConvergedIncrements) {
  Deck deck = test::uniaxial_deck(8.0);
  deck.steps.max_increment = 0.2;
  StopAfter stop;
  const DeckRun done = run(block(), deck, {}, {}, stop);
  ASSERT_FALSE(done.completed());
  EXPECT_EQ(done.failure->code, ErrorCode::kCancelled);
  ASSERT_TRUE(done.last);
  EXPECT_GT(done.last->time, 0.3);
  EXPECT_LT(done.last->time, 0.6);
  EXPECT_TRUE(done.last->attempts.back().stop == fem::NewtonStop::kConverged);
}

TEST(RunDeck, AnErrorOfTheWatchIsReturned) {
  DeckWatch watch;
  watch.on_increment = [](const Increment&) -> Result<void> {
    return fail(ErrorCode::kFileUnwritable, "the disk is full");
  };
  const auto prepared = prepare_deck(block(), test::uniaxial_deck(1.0));
  const auto done = run_deck(*prepared, {}, watch);
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().message, "the disk is full");
}

// --- Tolerance -----------------------------------------------------------------------------------

TEST(RunDeck, AFarNodeOfNoElementChangesNothing) {
  Deck deck = test::clamped_deck();
  deck.tractions.push_back({"z1", Vec3(2e-4, 0, 0), {}});
  mesh::VolumeMesh mesh = block();
  const DeckRun alone = run(mesh, deck);
  mesh.nodes_L.emplace_back(1e6, -1e6, 1e6);
  const DeckRun with_another = run(mesh, deck);
  ASSERT_TRUE(alone.completed() && with_another.completed());
  EXPECT_LT(with_another.last->relative_residual, 1e-8);
  EXPECT_GT(alone.last->max_displacement_mm, 0.1);
  EXPECT_EQ(with_another.last->u.head(alone.last->u.size()), alone.last->u);
}

TEST(RunDeck, ASoftRegionIsSolvedBesideAStiffOne) {
  // Titanium below 5 mm, fat with a tiny load above; 300 mm from the origin.
  mesh::VolumeMesh mesh = test::box_mesh({.cells = {2, 2, 4}, .size_mm = {10, 10, 20}});
  for (Vec3& p_L : mesh.nodes_L) p_L += Vec3::Constant(300.0);
  mesh::ElementBlock& elements = mesh.blocks[0];
  for (Index e = 0; e < elements.element_count(); ++e) {
    double z = 0.0;
    for (int a = 0; a < 4; ++a) z += mesh.nodes_L[std::size_t(elements.element(e)[a])].z() / 4.0;
    elements.region[std::size_t(e)] = z < 305.0 ? 1 : 0;
  }
  Deck deck = test::clamped_deck();
  deck.laws[0].law = fem::NeoHookean::from_young_poisson(1e-3, 0.45).value();
  deck.laws.push_back({"1", fem::NeoHookean::from_young_poisson(1.1e5, 0.3).value(), 0.0});
  deck.tractions.push_back({"z1", Vec3(1e-5, 0, 0), {}});
  DeckWatch watch;
  watch.on_increment = [](const Increment& increment) -> Result<void> {
    EXPECT_GT(increment.newton_iterations(), 0) << increment.time;
    EXPECT_LT(increment.relative_residual, 1e-3) << increment.time;
    return {};
  };
  const DeckRun done = run(mesh, deck, {}, watch);
  ASSERT_TRUE(done.completed()) << done.failure->message;
  EXPECT_LT((sum(done.last->reactions_n) + Vec3(1e-3, 0, 0)).norm(), 1e-6);
}

TEST(RunDeck, ABodyAtRestIsInEquilibriumAtAnyStiffness) {
  mesh::VolumeMesh mesh = block(mesh::ElementShape::kHex20);
  for (Vec3& p_L : mesh.nodes_L) p_L += Vec3(300.0, -400.0, 1200.0);
  Deck deck = test::uniaxial_deck(2.0);
  deck.laws[0].law = fem::NeoHookean::from_young_poisson(1.1e5, 0.3).value();
  deck.displacements[3].curve = LoadCurve{{{0.0, 0.0}, {0.3, 0.0}, {0.6, 1.0}, {1.0, 0.0}}};
  const DeckRun done = run(mesh, deck);
  ASSERT_TRUE(done.completed()) << done.failure->message;
  EXPECT_LT(done.last->max_displacement_mm, 1e-9);
}

TEST(RunDeck, ABodyInRigidMotionKeepsItsShape) {
  Deck deck = test::clamped_deck();
  deck.displacements = {prescribe("z0", 30.0, -20.0, 0.0)};
  const DeckRun done = run(block(mesh::ElementShape::kTet10), deck);
  ASSERT_TRUE(done.completed()) << done.failure->message;
  for (Index n = 0; n < done.last->u.size() / 3; ++n)
    EXPECT_LT((done.last->u.segment<3>(3 * n) - Vec3(30, -20, 0)).norm(), 1e-8);
}

// --- Obstacles -----------------------------------------------------------------------------------

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
  const auto& touched = done.last->touched[0];
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
  return {.at = at, .translation_mm = {0.0, 0.0, by_mm}};
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
    EXPECT_LE(contact.p99_depth_from_rest_mm, 0.005);
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
}  // namespace lefort::solve
