#include <lefort/io/deck_file.h>
#include <lefort/io/write_atomically.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <functional>
#include <numbers>

#include "support/temporary_folder.h"

namespace lefort::io::test_deck_file {
namespace {

using Json = nlohmann::json;

Json good_deck() {
  return Json::parse(R"({
    "lefort_deck": 1,
    "title": "test",
    "mesh": "meshes/block.vtu",
    "regions": "material",
    "mm_per_unit": 1000,
    "sets": {
      "low": {"box_mm": [[0, 0, 0], [1, 2, 3]]},
      "cut": {"plane": {"point_mm": [1, 2, 3], "normal": [0, 0, 2], "within_mm": 0.5}},
      "few": {"nodes": [3, 1]},
      "tip": {"nearest_mm": [4, 5, 6]},
      "fat": {"region": 7}
    },
    "materials": [
      {"region": 2, "law": "neo-hookean", "young_kpa": 26, "poisson": 0.3, "density_kg_m3": 1000},
      {"law": "linear-elastic", "mu_kpa": 4, "lambda_kpa": 5}
    ],
    "displacements": [{"set": "low", "x_mm": 0, "z_mm": -1.5, "curve": [[0, 0], [0.5, 1], [1, 0]]}],
    "motions": [{"set": "cut", "keyframes": [{"rotation_deg": [0, 0, 90], "about_mm": [1, 1, 1]}]}],
    "tractions": [{"faces": "few", "traction_kpa": [1, 2, 3]}],
    "pressures": [{"faces": "few", "pressure_kpa": -4}],
    "body_forces": [{"region": "muscle", "acceleration_m_s2": [0, 0, -9.81]}],
    "obstacles": [{"name": "ball", "file": "ball.stl", "faces": "few", "stiffness_kpa_per_mm": 8,
                   "contact_snap_mm": 0.25, "detection": "trilinear", "resolution": 64,
                   "band_mm": 3, "keyframes": [{"time": 0.5, "translation_mm": [0, 0, -1]}, {}]}],
    "steps": {"initial_increment": 0.25, "min_increment": 0.001, "max_increment": 0.5,
              "growth_factor": 1.5, "target_iterations": 4, "max_attempts": 77, "times": [0.3]},
    "newton": {"relative_tolerance": 1e-7, "absolute_tolerance_n": 1e-9, "max_iterations": 12},
    "linear_solver": "lagged",
    "probes": [{"name": "a", "node": 5}, {"name": "b", "point_mm": [7, 8, 9]}],
    "output": {"every": "times", "fields": ["displacement", "contact"]}
  })");
}

TEST(DeckFile, EveryKeyArrives) {
  const auto parsed = parse_deck(good_deck().dump(), "/cases/one");
  ASSERT_TRUE(parsed) << parsed.error().message;
  const DeckFile& file = *parsed;
  const solve::Deck& deck = file.deck;
  EXPECT_EQ(file.title, "test");
  EXPECT_EQ(file.mesh, std::filesystem::path("/cases/one/meshes/block.vtu"));
  EXPECT_EQ(file.mm_per_unit, 1000.0);
  EXPECT_EQ(file.regions, "material");

  ASSERT_EQ(deck.sets.size(), 5U);  // By name.
  EXPECT_EQ(deck.sets[0].name, "cut");
  EXPECT_EQ(std::get<solve::NodesOnPlane>(deck.sets[0].nodes).normal_L, Vec3::UnitZ());
  EXPECT_EQ(std::get<solve::NodesOnPlane>(deck.sets[0].nodes).within_mm, 0.5);
  EXPECT_EQ(std::get<solve::NodesOfRegion>(deck.sets[1].nodes).region, "7");
  EXPECT_EQ(std::get<solve::NodesByNumber>(deck.sets[2].nodes).nodes.size(), 2U);
  EXPECT_EQ(std::get<solve::NodesInBox>(deck.sets[3].nodes).box_L.max(), Vec3(1, 2, 3));
  EXPECT_EQ(std::get<solve::NodeNearest>(deck.sets[4].nodes).point_L, Vec3(4, 5, 6));

  ASSERT_EQ(deck.laws.size(), 2U);
  EXPECT_EQ(deck.laws[0].region, "2");
  EXPECT_NEAR(std::get<fem::NeoHookean>(deck.laws[0].law).mu_mpa, 0.01, 1e-15);
  EXPECT_NEAR(deck.laws[0].density_t_per_mm3, 1e-9, 1e-24);
  EXPECT_EQ(deck.laws[1].region, "");
  EXPECT_EQ(std::get<fem::LinearElastic>(deck.laws[1].law).lambda_mpa, 0.005);

  ASSERT_EQ(deck.displacements.size(), 1U);
  EXPECT_EQ(deck.displacements[0].displacement_mm[0], 0.0);
  EXPECT_FALSE(deck.displacements[0].displacement_mm[1]);
  EXPECT_EQ(deck.displacements[0].displacement_mm[2], -1.5);
  EXPECT_EQ(factor_at(deck.displacements[0].curve, 0.75), 0.5);
  EXPECT_NEAR(deck.motions[0].path.keyframes[0].rotation_rad.z(), 0.5 * std::numbers::pi, 1e-15);
  EXPECT_LT((deck.tractions[0].traction_mpa - Vec3(1e-3, 2e-3, 3e-3)).norm(), 1e-18);
  EXPECT_EQ(deck.pressures[0].pressure_mpa, -4e-3);
  EXPECT_EQ(deck.body_forces[0].region, "muscle");
  EXPECT_EQ(deck.body_forces[0].acceleration_mm_per_s2, Vec3(0, 0, -9810));

  const solve::Obstacle& ball = deck.obstacles[0];
  EXPECT_EQ(ball.name, "ball");
  EXPECT_EQ(ball.stiffness_mpa_per_mm, 8e-3);
  EXPECT_EQ(ball.contact_snap_mm, 0.25);
  EXPECT_EQ(ball.detection, contact::DetectionMethod::kTrilinear);
  EXPECT_EQ(ball.integration, contact::Integration::kQuadrature);
  EXPECT_FALSE(ball.penetration_tolerance_mm);
  EXPECT_EQ(ball.path.keyframes.size(), 2U);
  EXPECT_EQ(file.obstacles[0].file, std::filesystem::path("/cases/one/ball.stl"));
  EXPECT_EQ(file.obstacles[0].options.resolution, 64);
  EXPECT_EQ(file.obstacles[0].options.band_mm, 3.0);

  EXPECT_EQ(deck.steps.first_increment, 0.25);
  EXPECT_EQ(deck.steps.min_increment, 0.001);
  EXPECT_EQ(deck.steps.max_increment, 0.5);
  EXPECT_EQ(deck.steps.growth_factor, 1.5);
  EXPECT_EQ(deck.steps.target_iterations, 4);
  EXPECT_EQ(deck.steps.max_attempts, 77);
  EXPECT_EQ(deck.times, std::vector<double>{0.3});
  EXPECT_EQ(deck.newton.relative_tolerance, 1e-7);
  EXPECT_EQ(deck.newton.max_iterations, 12);
  EXPECT_EQ(deck.newton.absolute_tolerance_n, 1e-9);
  EXPECT_EQ(deck.linear_solver.kind, linear::LinearSolverKind::kReusedFactor);
  EXPECT_EQ(std::get<std::int32_t>(deck.probes[0].at), 5);
  EXPECT_EQ(std::get<Vec3>(deck.probes[1].at), Vec3(7, 8, 9));
  EXPECT_EQ(file.every, WriteEvery::kRequestedTime);
  EXPECT_TRUE(file.fields.displacement && file.fields.contact);
  EXPECT_FALSE(file.fields.stress || file.fields.stretches || file.fields.energy);
}

TEST(DeckFile, ASmallLargestIncrementMakesTheOthersAsSmall) {
  Json json = good_deck();
  json["output"].erase("every");
  json["steps"] = {{"max_increment", 0.05}};
  EXPECT_EQ(parse_deck(json.dump(), ".").value().deck.steps.first_increment, 0.05);
  json["steps"] = {{"initial_increment", 1e-5}};
  EXPECT_EQ(parse_deck(json.dump(), ".").value().deck.steps.min_increment, 1e-5);
}

template <class Law>
Law law_of(const char* material) {
  Json json = good_deck();
  json["materials"] = {Json::parse(material)};
  const auto parsed = parse_deck(json.dump(), ".");
  EXPECT_TRUE(parsed) << parsed.error().message;
  EXPECT_TRUE(std::holds_alternative<Law>(parsed->deck.laws[0].law)) << material;
  return std::get<Law>(parsed->deck.laws[0].law);
}

TEST(DeckFile, EveryLawArrivesWithItsConstants) {
  using fem::DecoupledLaw;
  const auto hooke = law_of<fem::StVenantKirchhoff>(
      R"({"law": "st-venant-kirchhoff", "young_kpa": 26, "poisson": 0.3})");
  EXPECT_NEAR(hooke.mu_mpa, 0.01, 1e-15);
  const auto neo = law_of<DecoupledLaw<fem::IsochoricNeoHookean>>(
      R"({"law": "isochoric-neo-hookean", "mu_kpa": 2, "bulk_kpa": 3, "volumetric": "log-squared"})");
  EXPECT_EQ(neo.isochoric.mu_mpa, 0.002);
  EXPECT_EQ(neo.volume.kappa_mpa, 0.003);
  EXPECT_EQ(neo.volume.form, fem::VolumetricForm::kLogSquared);
  const auto mooney = law_of<DecoupledLaw<fem::MooneyRivlin>>(
      R"({"law": "mooney-rivlin", "c10_kpa": 1, "c01_kpa": 2, "bulk_kpa": 3})");
  EXPECT_EQ(mooney.isochoric.c01_mpa, 0.002);
  EXPECT_EQ(mooney.volume.form, fem::VolumetricForm::kQuadratic);
  const auto yeoh = law_of<DecoupledLaw<fem::Yeoh>>(
      R"({"law": "yeoh", "c10_kpa": 1, "c30_kpa": 4, "bulk_kpa": 3})");
  EXPECT_EQ(yeoh.isochoric.c20_mpa, 0.0);
  EXPECT_EQ(yeoh.isochoric.c30_mpa, 0.004);
  const auto ogden = law_of<DecoupledLaw<fem::Ogden>>(
      R"({"law": "ogden", "mu_kpa": [1, -2], "alpha": [2, -3], "bulk_kpa": 3})");
  EXPECT_EQ(ogden.isochoric.terms[1].mu_mpa, -0.002);
  EXPECT_EQ(ogden.isochoric.terms[1].alpha, -3.0);
  EXPECT_EQ(ogden.isochoric.terms[2].alpha, 0.0);
  const auto fung = law_of<DecoupledLaw<fem::FungOrthotropic>>(
      R"({"law": "fung-orthotropic", "mu_kpa": [1, 2, 3], "c_kpa": 4, "bulk_kpa": 5,
          "lambda_kpa": [[2, 1, 0], [1, 3, 0], [0, 0, 4]],
          "axes": [[0, 2, 0], [-1, 0, 0], [0, 0, 1]]})");
  EXPECT_EQ(fung.isochoric.mu_mpa[2], 0.003);
  EXPECT_EQ(fung.isochoric.lambda_mpa(0, 1), 0.001);
  EXPECT_EQ(fung.isochoric.axes.col(0), Vec3::UnitY());
  EXPECT_EQ(fung.isochoric.axes.col(1), -Vec3::UnitX());
  const auto hgo = law_of<DecoupledLaw<fem::HolzapfelGasserOgden>>(
      R"({"law": "holzapfel-gasser-ogden", "mu_kpa": 1, "k1_kpa": 2, "k2": 3, "bulk_kpa": 4,
          "dispersion": 0.1, "fibers": [[0, 0, 5], [3, 0, 0]]})");
  EXPECT_EQ(hgo.isochoric.family_count, 2);
  EXPECT_EQ(hgo.isochoric.fiber[0], Vec3::UnitZ());
  EXPECT_EQ(hgo.isochoric.dispersion, 0.1);
}

TEST(DeckFile, ALawsListsMustFit) {
  const auto refusal = [](const char* material) {
    Json json = good_deck();
    json["materials"] = {Json::parse(material)};
    const auto parsed = parse_deck(json.dump(), ".");
    return parsed ? std::string("read") : parsed.error().message;
  };
  EXPECT_EQ(refusal(R"({"law": "ogden", "mu_kpa": [1, 2], "alpha": [2], "bulk_kpa": 3})"),
            "materials[0]: constant 'alpha' must be as many numbers as mu_kpa");
  EXPECT_EQ(refusal(R"({"law": "ogden", "mu_kpa": [1, 2, 3, 4], "alpha": [2], "bulk_kpa": 3})"),
            "materials[0]: constant 'mu_kpa' must be a list of 1 to 3 numbers");
  EXPECT_EQ(refusal(R"({"law": "ogden", "mu_kpa": [1], "alpha": [2]})"),
            "materials[0]: constant 'bulk_kpa' is missing");
  EXPECT_EQ(refusal(R"({"law": "holzapfel-gasser-ogden", "mu_kpa": 1, "k1_kpa": 2, "k2": 3,
                        "bulk_kpa": 4, "fibers": [[0, 0]]})"),
            "materials[0]: constant 'fibers' must be a list of 1 to 2 vectors");
  EXPECT_NE(refusal(R"({"law": "holzapfel-gasser-ogden", "mu_kpa": 1, "k1_kpa": 2, "k2": 3,
                        "bulk_kpa": 4, "fibers": [[0, 0, 0]]})"),
            "read");
  EXPECT_NE(refusal(R"({"law": "yeoh", "c10_kpa": 1, "bulk_kpa": 3, "volumetric": "cubic"})"),
            "read");
}

struct BadDeck {
  const char* name;
  std::function<void(Json&)> spoil;
  const char* named;  ///< What the message must say.
};

class DeckFileRefuses : public testing::TestWithParam<BadDeck> {};

TEST_P(DeckFileRefuses, AndNamesTheKey) {
  Json json = good_deck();
  GetParam().spoil(json);
  const auto deck = parse_deck(json.dump(), ".");
  ASSERT_FALSE(deck);
  EXPECT_EQ(deck.error().code, ErrorCode::kPlanInvalid);
  EXPECT_NE(deck.error().message.find(GetParam().named), std::string::npos) << deck.error().message;
  EXPECT_EQ(deck.error().message.find('\n'), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(
    Decks, DeckFileRefuses,
    testing::Values(
        BadDeck{"UnknownKey", [](Json& j) { j["steps"]["color"] = 1; },
                "steps: unknown key 'color'"},
        BadDeck{"UnknownKeyOnTop", [](Json& j) { j["obstacle"] = 1; }, "unknown key 'obstacle'"},
        BadDeck{"NoMesh", [](Json& j) { j.erase("mesh"); }, "'mesh'"},
        BadDeck{"WrongVersion", [](Json& j) { j["lefort_deck"] = 2; }, "lefort_deck"},
        BadDeck{"NoMaterials", [](Json& j) { j["materials"] = Json::array(); }, "materials"},
        BadDeck{"UnknownLaw", [](Json& j) { j["materials"][0]["law"] = "rubber"; },
                "materials[0]: there is no law 'rubber', the laws are: "},
        BadDeck{"NegativeModulus", [](Json& j) { j["materials"][0]["young_kpa"] = -26; },
                "materials[0]: neo-hookean: young's modulus is -0.026 MPa, must be > 0"},
        BadDeck{"Incompressible", [](Json& j) { j["materials"][0]["poisson"] = 0.5; },
                "materials[0]: neo-hookean: poisson's ratio is 0.5, must be < 0.5"},
        BadDeck{"MissingConstant", [](Json& j) { j["materials"][0].erase("poisson"); },
                "materials[0]: constant 'poisson' is missing"},
        BadDeck{"ConstantOfAnotherLaw", [](Json& j) { j["materials"][0]["k1_kpa"] = 1; },
                "materials[0]: unknown key 'k1_kpa', law neo-hookean takes poisson, young_kpa"},
        BadDeck{"ListForConstant",
                [](Json& j) {
                  j["materials"][0]["poisson"] = {1, 2};
                },
                "materials[0]: constant 'poisson' must be a number"},
        BadDeck{"TextForConstant", [](Json& j) { j["materials"][0]["poisson"] = "soft"; },
                "materials[0].poisson"},
        BadDeck{"SetOfTwoKinds",
                [](Json& j) {
                  j["sets"]["few"]["nearest_mm"] = {0, 0, 0};
                },
                "sets.few"},
        BadDeck{"BoxInsideOut",
                [](Json& j) {
                  j["sets"]["low"]["box_mm"][0] = {0, 3, 0};
                },
                "sets.low: the first corner"},
        BadDeck{"ZeroNormal",
                [](Json& j) {
                  j["sets"]["cut"]["plane"]["normal"] = {0, 0, 0};
                },
                "sets.cut.plane.normal: the vector is zero"},
        BadDeck{"NothingPrescribed",
                [](Json& j) {
                  j["displacements"][0].erase("x_mm");
                  j["displacements"][0].erase("z_mm");
                },
                "displacements[0]: none of x_mm, y_mm, z_mm"},
        BadDeck{"CurveBackwards",
                [](Json& j) {
                  j["displacements"][0]["curve"] = {{0.5, 0}, {0.25, 1}};
                },
                "displacements[0].curve: the times of the curve must ascend"},
        BadDeck{"CurveBeyondTheEnd",
                [](Json& j) {
                  j["displacements"][0]["curve"] = {{0, 0}, {2, 1}};
                },
                "displacements[0].curve: a time of the curve is 2"},
        BadDeck{"ShortVector",
                [](Json& j) {
                  j["tractions"][0]["traction_kpa"] = {1, 2};
                },
                "tractions[0].traction_kpa"},
        BadDeck{"KeyframesEndEarly", [](Json& j) { j["obstacles"][0]["keyframes"].erase(1); },
                "obstacles[0].keyframes: path of 'ball': the last keyframe is at 0.5"},
        BadDeck{"ObstacleTwice", [](Json& j) { j["obstacles"].push_back(Json(j["obstacles"][0])); },
                "obstacles[1]: the name ball stands twice"},
        BadDeck{"ProbeTwice", [](Json& j) { j["probes"][1]["name"] = "a"; },
                "probes[1]: the name a stands twice"},
        BadDeck{"ProbeNowhere", [](Json& j) { j["probes"][1].erase("point_mm"); }, "probes[1]"},
        BadDeck{"ProbeWithAComma", [](Json& j) { j["probes"][0]["name"] = "a,b"; },
                "probes[0].name"},
        BadDeck{"SmallestAboveInitial", [](Json& j) { j["steps"]["min_increment"] = 0.3; },
                "steps.min_increment: 0.3 is more than steps.initial_increment, 0.25"},
        BadDeck{"InitialAboveLargest", [](Json& j) { j["steps"]["initial_increment"] = 0.7; },
                "steps.initial_increment: 0.7 is more than steps.max_increment, 0.5"},
        BadDeck{"TimesAskedForWithoutAny", [](Json& j) { j["steps"].erase("times"); },
                "output.every: times needs steps.times"},
        BadDeck{"FieldTwice",
                [](Json& j) {
                  j["output"]["fields"] = Json::array();  // Compared in pairs, 3000 took 1.2 GB.
                  for (int n = 0; n < 20'000; ++n) j["output"]["fields"].push_back("stress");
                },
                "output.fields: a field stands twice"},
        BadDeck{"UnknownField", [](Json& j) { j["output"]["fields"][0] = "color"; },
                "output.fields[0]"},
        BadDeck{"UnknownSolver", [](Json& j) { j["linear_solver"] = "magic"; }, "linear_solver"},
        BadDeck{"OddResolution", [](Json& j) { j["obstacles"][0]["resolution"] = 100; },
                "obstacles[0].resolution"},
        BadDeck{"NotAnObject", [](Json& j) { j = Json::array(); }, "the deck"}),
    [](const auto& param_info) { return param_info.param.name; });

TEST(DeckFile, NamesTheFileThatIsMissingOrNoJson) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(read_deck(folder / "none.json").error().code, ErrorCode::kFileNotFound);
  ASSERT_TRUE(write_text(folder / "bad.json", "{"));
  const auto bad = read_deck(folder / "bad.json");
  ASSERT_FALSE(bad);
  EXPECT_NE(bad.error().message.find("bad.json: not JSON"), std::string::npos);
  ASSERT_TRUE(write_text(folder / "good.json", good_deck().dump()));
  const auto good = read_deck(folder / "good.json");
  ASSERT_TRUE(good);
  EXPECT_EQ(good->file.mesh, folder / "meshes/block.vtu");
  EXPECT_EQ(good->json, good_deck().dump());
}

}  // namespace
}  // namespace lefort::io::test_deck_file
