#include <lefort/solve/run_deck.h>

#include <gtest/gtest.h>

#include <cmath>

#include "solve/block.h"
#include "solve/run.h"
#include "support/box_mesh.h"

namespace lefort::solve::test_run_deck {
namespace {

using test::block;
using test::kBlockLaw;
using test::prescribe;
using test::run;
using test::sum;

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

}  // namespace
}  // namespace lefort::solve::test_run_deck
