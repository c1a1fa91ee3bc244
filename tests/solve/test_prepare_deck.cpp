#include <lefort/mesh/element_faces.h>
#include <lefort/solve/mesh_index.h>
#include <lefort/solve/prepare_deck.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "solve/block.h"

namespace lefort::solve::test_prepare_deck {
namespace {

using test::block;
using test::prescribe;

std::string refusal_of(mesh::VolumeMesh mesh, Deck deck) {
  const auto prepared = prepare_deck(std::move(mesh), std::move(deck));
  return prepared ? std::string("accepted") : prepared.error().message;
}

#define EXPECT_SAYS(text, part) \
  EXPECT_NE((text).find(part), std::string::npos) << "says: " << (text)

TEST(PrepareDeck, EveryComponentIsPrescribedOnceByTheFirst) {
  const auto prepared = prepare_deck(block(), test::uniaxial_deck(4.0));
  ASSERT_TRUE(prepared) << prepared.error().message;
  EXPECT_EQ(prepared->prescribed.size(), 15U + 15U + 9U + 9U);
  const auto at_half = prescribed_at(*prepared, 0.5);
  for (std::size_t i = 0; i < at_half.size(); ++i) {
    EXPECT_EQ(at_half[i].node, prepared->prescribed[i].node);
    EXPECT_EQ(at_half[i].component, prepared->prescribed[i].component);
    EXPECT_EQ(at_half[i].displacement_mm, prepared->prescribed[i].by == 3 ? 2.0 : 0.0);
  }
}

TEST(PrepareDeck, ShapesUnsuitableForNearlyIncompressibleLawsAreReported) {
  const fem::DecoupledLaw<fem::IsochoricNeoHookean> decoupled{.isochoric = {.mu_mpa = 0.01},
                                                              .volume = {.kappa_mpa = 5.0}};
  const fem::NeoHookean coupled{.mu_mpa = 0.01, .lambda_mpa = 5.0};
  const auto warnings_of = [](mesh::ElementShape shape, const fem::Material& law) {
    Deck deck = test::uniaxial_deck(1.0);
    deck.laws[0].law = law;
    return prepare_deck(block(shape), deck).value().warnings;
  };
  using enum mesh::ElementShape;
  for (const mesh::ElementShape shape : {kTet4, kWedge6, kPyramid5}) {
    const auto warnings = warnings_of(shape, decoupled);
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_SAYS(warnings[0], std::string(mesh::name_of(shape)) + " with a nearly incompressible");
    EXPECT_SAYS(warnings[0], "0.4990) lock: they are too stiff; use tet10, wedge15 or hex20");
    EXPECT_TRUE(warnings_of(shape, test::kBlockLaw).empty());
  }
  ASSERT_EQ(warnings_of(kHex8, decoupled).size(), 1U);
  EXPECT_SAYS(warnings_of(kHex8, decoupled)[0], "the pressure of 16 hex8");
  EXPECT_SAYS(warnings_of(kHex8, coupled)[0], "lock");
  for (const mesh::ElementShape shape : {kTet10, kWedge15, kHex20})
    EXPECT_TRUE(warnings_of(shape, decoupled).empty());
}

TEST(PrepareDeck, SetsThatMeetMustAgree) {
  Deck deck = test::uniaxial_deck(1.0);
  deck.displacements.push_back(prescribe("x0", {}, {}, 0.0));
  const std::string refusal = refusal_of(block(), deck);
  EXPECT_SAYS(refusal, "displacements[3] (set z1) and displacements[4] (set x0) both prescribe z");
  // At the corner both are 0.
  deck.displacements.back() = prescribe("y0", 0.0, {}, {});
  EXPECT_EQ(refusal_of(block(), deck), "accepted");
}

TEST(PrepareDeck, IncrementsEndAtCornersOfCurvesAndKeyframes) {
  Deck deck = test::uniaxial_deck(1.0);
  deck.displacements[3].curve = LoadCurve{{{0.0, 0.0}, {0.25, 1.0}, {1.0, 0.0}}};
  deck.times = {0.6, 0.1 + 0.15, 0.6 + 1e-12, 1e-15, 1.0 - 1e-13};
  const auto prepared = prepare_deck(block(), deck);
  ASSERT_TRUE(prepared);
  EXPECT_EQ(prepared->levels, (std::vector<double>{0.25, 0.6, 1.0}));
}

TEST(PrepareDeck, ARegionWithoutAMaterialIsReported) {
  mesh::VolumeMesh mesh = block();
  mesh.blocks[0].region[5] = 3;
  Deck deck = test::uniaxial_deck(1.0);
  deck.laws[0].region = "0";
  EXPECT_EQ(refusal_of(mesh, deck), "materials: region 3 of the mesh (1 elements) has no material");
  deck.laws.push_back({"3", fem::NeoHookean{.mu_mpa = 2.0, .lambda_mpa = 1.0}, 0.0});
  EXPECT_EQ(refusal_of(mesh, deck), "accepted");
  deck.laws[1].region = "4";
  EXPECT_EQ(refusal_of(mesh, deck), "materials[1]: there is no region 4; the regions are: 0, 3");
  deck.laws[1].region = "0";
  EXPECT_EQ(refusal_of(mesh, deck),
            "materials[0] and materials[1] are both for region 0; only one may be");
}

TEST(PrepareDeck, OneMaterialMayBeForAllOtherRegions) {
  mesh::VolumeMesh mesh = block();
  mesh.blocks[0].region[5] = 3;
  Deck deck = test::uniaxial_deck(1.0);
  deck.laws.push_back({"3", fem::NeoHookean{.mu_mpa = 2.0, .lambda_mpa = 1.0}, 0.0});
  const auto prepared = prepare_deck(mesh, deck);
  ASSERT_TRUE(prepared);
  EXPECT_EQ(std::get<fem::NeoHookean>(prepared->materials.at(3)).mu_mpa, 2.0);
  EXPECT_EQ(std::get<fem::NeoHookean>(prepared->materials.at(0)).mu_mpa, 0.01);
}

TEST(PrepareDeck, AnUnconstrainedPartIsRejectedBeforeTheSolve) {
  Deck deck = test::uniaxial_deck(1.0);
  deck.displacements.erase(deck.displacements.begin());  // x is free.
  const std::string refusal = refusal_of(block(), deck);
  EXPECT_SAYS(refusal, "displacements: the part of 96 elements around element 0 at (");
  EXPECT_SAYS(refusal, "as a rigid body; it is not fixed");
}

TEST(PrepareDeck, ABodyForceNeedsADensity) {
  Deck deck = test::clamped_deck();
  deck.body_forces.push_back({"", Vec3(0, 0, -9810), {}});
  EXPECT_EQ(refusal_of(block(), deck),
            "body_forces[0]: the material of region 0 has no density_kg_m3");
}

TEST(PrepareDeck, NodesOfNoElementDoNotMoveAndAreReported) {
  mesh::VolumeMesh mesh = block();
  mesh.nodes_L.emplace_back(50, 50, 50);
  const auto prepared = prepare_deck(mesh, test::uniaxial_deck(1.0));
  ASSERT_TRUE(prepared) << prepared.error().message;
  ASSERT_EQ(prepared->warnings.size(), 1U);
  EXPECT_EQ(prepared->warnings[0], "1 nodes belong to no element and do not move");
  EXPECT_EQ(prepared->prescribed.back().by, -1);
}

TEST(PrepareDeck, WarnsOfALoadThatDoesNotStartAtZero) {
  Deck deck = test::uniaxial_deck(1.0);
  deck.displacements[3].curve = LoadCurve{{{0.0, 1.0}}};
  const auto prepared = prepare_deck(block(), deck);
  ASSERT_TRUE(prepared);
  ASSERT_EQ(prepared->warnings.size(), 1U);
  EXPECT_SAYS(prepared->warnings[0], "displacements[3]: the curve begins at 1");
}

TEST(PrepareDeck, BadMeshesAreRejectedWithOneMessage) {
  mesh::VolumeMesh lost = block();
  lost.blocks[0].nodes[9] = 4711;
  EXPECT_SAYS(refusal_of(lost, test::clamped_deck()), "has node 4711");
  mesh::VolumeMesh nan = block();
  nan.nodes_L[3].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_SAYS(refusal_of(nan, test::clamped_deck()), "node 3 has a coordinate that is not finite");
  mesh::VolumeMesh turned = block();
  std::swap(turned.blocks[0].nodes[0], turned.blocks[0].nodes[1]);
  EXPECT_SAYS(refusal_of(turned, test::clamped_deck()), "element 0 at (");
  EXPECT_SAYS(refusal_of({}, test::clamped_deck()), "the mesh has no element");
}

TEST(PrepareDeck, NeighborsThatShareCornersButNotMidsideNodesAreRejected) {
  mesh::VolumeMesh mesh = block(mesh::ElementShape::kTet10);
  mesh::ElementBlock& quadratic = mesh.blocks[0];
  mesh::ElementBlock linear;
  const std::int32_t* const last = quadratic.element(quadratic.element_count() - 1);
  linear.nodes.assign(last, last + 4);
  linear.region = {0};
  quadratic.nodes.resize(quadratic.nodes.size() - 10);
  quadratic.region.pop_back();
  mesh.blocks.push_back(linear);
  const std::string refusal = refusal_of(mesh, test::clamped_deck());
  EXPECT_SAYS(refusal, " and 95 share the corners of a face at (");
  EXPECT_SAYS(refusal, "(6 and 3)");
}

TEST(PrepareDeck, OnlyTractionsMayActInsideTheBody) {
  mesh::VolumeMesh mesh = block();
  // A face of the first element and of another one.
  const mesh::ElementBlock& elements = mesh.blocks[0];
  for (const mesh::LocalFace& local : mesh::faces_of(elements.shape)) {
    const mesh::Face face = mesh::face_of(elements.element(0), local);
    const MeshIndex index = index_mesh(mesh);
    if (faces_like(index, face).size() == 2) mesh.face_sets["cut"] = {face};
  }
  ASSERT_EQ(mesh.face_sets.at("cut").size(), 1U);
  Deck pressed = test::clamped_deck();
  pressed.pressures.push_back({"cut", 1e-4, {}});
  const std::string refusal = refusal_of(mesh, pressed);
  EXPECT_SAYS(refusal, "pressures[0]: faces cut contain one between elements 0 and ");
  EXPECT_SAYS(refusal, " mm; all must lie on the boundary");
  Deck touched = test::clamped_deck();
  Obstacle obstacle;
  obstacle.faces = "cut";
  obstacle.path.keyframes = {geometry::Keyframe{}};
  obstacle.path.steps = 1;
  touched.obstacles.push_back(obstacle);
  EXPECT_SAYS(refusal_of(mesh, touched), "obstacles[0]: faces cut contain one between elements 0");
  Deck drawn = test::clamped_deck();
  drawn.tractions.push_back({"cut", Vec3(1e-4, 0, 0), {}});
  const auto prepared = prepare_deck(mesh, drawn);
  ASSERT_TRUE(prepared) << prepared.error().message;
  ASSERT_EQ(prepared->warnings.size(), 1U);
  EXPECT_SAYS(prepared->warnings[0], "tractions[0]: faces cut contain one between elements 0 and ");
}

TEST(PrepareDeck, ContactStiffnessFollowsTheElementsOfItsFaces) {
  mesh::VolumeMesh mesh = block();
  mesh::ElementBlock& elements = mesh.blocks[0];
  const auto& top = mesh.node_sets.at("z1");
  for (Index e = 0; e < elements.element_count(); ++e) {
    const auto in_top = std::count_if(elements.element(e), elements.element(e) + 4, [&](auto node) {
      return std::binary_search(top.begin(), top.end(), node);
    });
    if (in_top < 3) elements.region[std::size_t(e)] = 1;  // Some have only an edge there.
  }
  Deck deck = test::clamped_deck();
  Obstacle obstacle;
  obstacle.faces = "z1";
  obstacle.path.keyframes = {geometry::Keyframe{}};
  obstacle.path.steps = 1;
  deck.obstacles.push_back(obstacle);
  const auto stiffness = [&](double mu_mpa) {
    deck.laws = {{"0", test::kBlockLaw, 0.0},
                 {"1", fem::NeoHookean{.mu_mpa = mu_mpa, .lambda_mpa = 0.04}, 0.0}};
    return prepare_deck(mesh, deck).value().obstacle_stiffness_mpa_per_mm.at(0);
  };
  EXPECT_EQ(stiffness(1e4), stiffness(0.01));
}

TEST(PrepareDeck, AFaceOfThreeElementsIsRejected) {
  mesh::VolumeMesh mesh = block();
  mesh::ElementBlock& elements = mesh.blocks[0];
  const std::vector<std::int32_t> again(elements.element(0), elements.element(0) + 4);
  elements.nodes.insert(elements.nodes.end(), again.begin(), again.end());
  elements.region.push_back(0);
  const std::string refusal = refusal_of(mesh, test::clamped_deck());
  EXPECT_SAYS(refusal, "elements 0, ");
  EXPECT_SAYS(refusal, "and 96 share one face at (");
}

TEST(PrepareDeck, WarnsOfAQuadrilateralOnTwoTriangles) {
  // A hexahedron, and on it the six tetrahedra of another one.
  mesh::VolumeMesh mesh = test::box_mesh({.cells = {1, 1, 2}});
  mesh::ElementBlock& tets = mesh.blocks[0];
  tets.nodes.erase(tets.nodes.begin(), tets.nodes.begin() + 6 * 4);
  tets.region.resize(6);
  mesh.blocks.push_back(
      {.shape = mesh::ElementShape::kHex8, .nodes = {0, 1, 3, 2, 4, 5, 7, 6}, .region = {0}});
  Deck deck = test::clamped_deck();
  deck.sets.push_back({"low", NodesInBox{Box3(Vec3(-1, -1, -1), Vec3(9, 9, 0.1))}});
  deck.displacements[0].set = "low";
  const auto prepared = prepare_deck(mesh, deck);
  ASSERT_TRUE(prepared) << prepared.error().message;
  ASSERT_EQ(prepared->warnings.size(), 1U);
  EXPECT_SAYS(prepared->warnings[0],
              "1 quadrilaterals lie on two triangles each and are connected to them only at "
              "their nodes; the first is of element 6 at (");
}

TEST(PrepareDeck, EveryUnknownNameIsReportedWithItsKey) {
  const auto refusal = [](const std::function<void(Deck&)>& spoil) {
    Deck deck = test::clamped_deck();
    spoil(deck);
    return refusal_of(block(), deck);
  };
  EXPECT_SAYS(refusal([](Deck& d) { d.displacements[0].set = "base"; }),
              "displacements[0]: there is no set base; the sets are: boundary, outside, x0");
  EXPECT_SAYS(refusal([](Deck& d) {
                d.tractions.push_back({"lid", Vec3::UnitX(), {}});
              }),
              "tractions[0]: there is no set lid");
  EXPECT_SAYS(refusal([](Deck& d) {
                d.pressures.push_back({"lid", 1.0, {}});
              }),
              "pressures[0]: there is no set lid");
  EXPECT_SAYS(refusal([](Deck& d) {
                d.body_forces.push_back({"5", Vec3::UnitX(), {}});
              }),
              "body_forces[0]: there is no region 5");
  EXPECT_SAYS(refusal([](Deck& d) {
                d.probes.push_back({"tip", Vec3(0, 0, 99)});
              }),
              "probes[0]: (0.000, 0.000, 99.000) mm lies in no element");
  EXPECT_SAYS(refusal([](Deck& d) {
                Obstacle obstacle;
                obstacle.faces = "lid";
                obstacle.path.keyframes = {geometry::Keyframe{}};
                obstacle.path.steps = 1;
                d.obstacles.push_back(obstacle);
              }),
              "obstacles[0]: there is no set lid");
  EXPECT_SAYS(refusal([](Deck& d) { d.displacements[0].curve.points.clear(); }),
              "displacements[0]: the curve has no point");
  EXPECT_SAYS(refusal([](Deck& d) { d.steps.growth_factor = 0.5; }), "growth_factor is 0.5");
}

}  // namespace
}  // namespace lefort::solve::test_prepare_deck
