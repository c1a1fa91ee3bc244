#include <lefort/io/plan_file.h>
#include <lefort/io/write_atomically.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <functional>
#include <numbers>
#include <random>

#include "support/temporary_folder.h"

namespace lefort::io {
namespace {

using Json = nlohmann::json;

Json good_plan() {
  return Json::parse(R"({
    "lefort_plan": 1,
    "title": "test",
    "ct": "scans/ct.nrrd",
    "segmentation": {"bone_hu": 300, "skin_hu": -200},
    "segments": [{
      "name": "midface",
      "osteotomy": {"planes": [{"point_mm": [1, 2, 3], "towards_segment": [0, -2, 0]}],
                    "smallest_piece_ml": 0.25, "smallest_piece_share": 0.125},
      "path": {"steps": 7, "keyframes": [
        {"at": 0.5, "translation_mm": [0, -3, 0]},
        {"at": 1, "translation_mm": [0, -6, -1], "rotation_deg": [0, 0, 90], "about_mm": [4, 5, 6]}]}
    }],
    "tissue": {"material": {"law": "neo-hookean", "young_kpa": 20, "poisson": 0.4},
               "element_size_mm": 3},
    "boundary": {"moved_bone": "attached", "scan_edge": "fixed", "release_mm": 5},
    "contact": {"stiffness_factor": 30, "detection": "bvh", "integration": "nodes",
                "penetration_tolerance_mm": 0.05},
    "field": {"resolution": 64, "band_mm": 4},
    "solver": {"relative_tolerance": 1e-7, "max_iterations": 12}
  })");
}

TEST(PlanFile, EveryKeyArrives) {
  const PlanFile plan = parse_plan(good_plan().dump(), "/cases/one").value();
  EXPECT_EQ(plan.title, "test");
  EXPECT_EQ(plan.ct, std::filesystem::path("/cases/one/scans/ct.nrrd"));
  EXPECT_EQ(plan.segmentation.bone_hu, 300.0);
  EXPECT_EQ(plan.segmentation.skin_hu, -200.0);
  EXPECT_EQ(plan.osteotomy.segment, "midface");
  ASSERT_EQ(plan.osteotomy.planes.size(), 1U);
  EXPECT_EQ(plan.osteotomy.planes[0].point_L, Vec3(1.0, 2.0, 3.0));
  EXPECT_EQ(plan.osteotomy.planes[0].normal_L, Vec3(0.0, -1.0, 0.0));
  EXPECT_EQ(plan.cut.smallest_piece_ml, 0.25);
  EXPECT_EQ(plan.cut.smallest_piece_share, 0.125);
  EXPECT_EQ(plan.path.steps, 7);
  ASSERT_EQ(plan.path.keyframes.size(), 2U);
  EXPECT_EQ(plan.path.keyframes[1].translation_mm, Vec3(0.0, -6.0, -1.0));
  EXPECT_NEAR(plan.path.keyframes[1].rotation_rad.z(), std::numbers::pi / 2.0, 1e-15);
  EXPECT_EQ(plan.path.keyframes[1].centre_L, Vec3(4.0, 5.0, 6.0));
  EXPECT_NEAR(plan.tissue.young_mpa, 0.02, 1e-15);
  EXPECT_EQ(plan.tissue.poisson, 0.4);
  EXPECT_EQ(plan.tissue.element_size_mm, 3.0);
  EXPECT_EQ(plan.boundary.moved_bone, predict::MovedBone::kAttached);
  EXPECT_EQ(plan.boundary.scan_edge, predict::ScanEdge::kFixed);
  EXPECT_EQ(plan.boundary.release_mm, 5.0);
  EXPECT_EQ(plan.contact.stiffness_factor, 30.0);
  EXPECT_EQ(plan.contact.detection, contact::Detection::kBvh);
  EXPECT_EQ(plan.contact.integration, contact::Integration::kNodes);
  EXPECT_EQ(plan.contact.penetration_tolerance_mm, 0.05);
  EXPECT_EQ(plan.field.resolution, 64);
  EXPECT_EQ(plan.field.band_mm, 4.0);
  EXPECT_EQ(plan.solver.relative_tolerance, 1e-7);
  EXPECT_EQ(plan.solver.max_iterations, 12);
}

TEST(PlanFile, WhatIsNotSaidHasItsDefault) {
  Json json = good_plan();
  for (const char* key : {"ct", "segmentation", "tissue", "boundary", "contact", "field", "solver"})
    json.erase(key);
  const PlanFile plan = parse_plan(json.dump(), ".").value();
  EXPECT_FALSE(plan.ct);
  EXPECT_EQ(plan.tissue.poisson, predict::TissueOptions{}.poisson);
  EXPECT_EQ(plan.boundary.moved_bone, predict::MovedBone::kContact);
}

TEST(PlanFile, CoarseElementsAloneMakeTheRimAsCoarse) {
  Json json = good_plan();
  json["tissue"]["element_size_mm"] = 9;
  EXPECT_EQ(parse_plan(json.dump(), ".").value().tissue.far_element_size_mm, 9.0);
}

struct BadPlan {
  const char* name;
  std::function<void(Json&)> spoil;
  const char* named;  ///< What the message must say.
};

class PlanFileRefuses : public testing::TestWithParam<BadPlan> {};

TEST_P(PlanFileRefuses, AndNamesTheKey) {
  Json json = good_plan();
  GetParam().spoil(json);
  const auto plan = parse_plan(json.dump(), ".");
  ASSERT_FALSE(plan);
  EXPECT_EQ(plan.error().code, ErrorCode::kPlanInvalid);
  EXPECT_NE(plan.error().message.find(GetParam().named), std::string::npos) << plan.error().message;
  EXPECT_EQ(plan.error().message.find('\n'), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(
    Plans, PlanFileRefuses,
    testing::Values(
        BadPlan{"UnknownKey", [](Json& j) { j["tissue"]["colour"] = 1; },
                "tissue: unknown key 'colour'"},
        BadPlan{"UnknownKeyOnTop", [](Json& j) { j["tisue"] = 1; }, "unknown key 'tisue'"},
        BadPlan{"MissingKey", [](Json& j) { j["segments"][0].erase("path"); }, "'path'"},
        BadPlan{"WrongVersion", [](Json& j) { j["lefort_plan"] = 2; }, "lefort_plan"},
        BadPlan{"NoSegments", [](Json& j) { j["segments"] = Json::array(); }, "segments"},
        BadPlan{"ShortVector",
                [](Json& j) {
                  j["segments"][0]["osteotomy"]["planes"][0]["point_mm"] = {1, 2};
                },
                "segments[0].osteotomy.planes[0].point_mm"},
        BadPlan{
            "TextForNumber",
            [](Json& j) { j["segments"][0]["path"]["keyframes"][0]["translation_mm"][1] = "far"; },
            "segments[0].path.keyframes[0].translation_mm[1]"},
        BadPlan{"ZeroNormal",
                [](Json& j) {
                  j["segments"][0]["osteotomy"]["planes"][0]["towards_segment"] = {0, 0, 0};
                },
                "segments[0].osteotomy.planes[0].towards_segment"},
        BadPlan{"KeyframesOutOfOrder",
                [](Json& j) { j["segments"][0]["path"]["keyframes"][1]["at"] = 0.4; }, "midface"},
        BadPlan{"OutOfRange", [](Json& j) { j["tissue"]["element_size_mm"] = -1; },
                "tissue.element_size_mm"},
        BadPlan{"FinerAtTheRim", [](Json& j) { j["tissue"]["far_element_size_mm"] = 2; },
                "tissue.far_element_size_mm: 2 is less than element_size_mm, 3"},
        BadPlan{"PascalsForKilopascals",
                [](Json& j) { j["tissue"]["material"]["young_kpa"] = 1e-3; },
                "tissue.material.young_kpa"},
        BadPlan{"PiecesOfOverAWhole",
                [](Json& j) { j["segments"][0]["osteotomy"]["smallest_piece_share"] = 1.5; },
                "segments[0].osteotomy.smallest_piece_share"},
        BadPlan{"Incompressible", [](Json& j) { j["tissue"]["material"]["poisson"] = 0.5; },
                "tissue.material.poisson"},
        BadPlan{"UnknownMaterial", [](Json& j) { j["tissue"]["material"] = "stone"; },
                "tissue.material"},
        BadPlan{"OddResolution", [](Json& j) { j["field"]["resolution"] = 100; },
                "field.resolution"},
        BadPlan{"NotAnObject", [](Json& j) { j = Json::array(); }, "plan"}),
    [](const auto& param_info) { return param_info.param.name; });

TEST(PlanFile, NamesTheFileThatIsMissingOrNoJson) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(read_plan(folder / "none.json").error().code, ErrorCode::kFileNotFound);
  for (const char* text : {"", "{", "nonsense", "{\"lefort_plan\": NaN}", "[1,2"}) {
    ASSERT_TRUE(write_text(folder / "bad.json", text));
    const auto plan = read_plan(folder / "bad.json");
    EXPECT_EQ(plan.error().code, ErrorCode::kPlanInvalid) << text;
    EXPECT_NE(plan.error().message.find("bad.json"), std::string::npos);
  }
}

TEST(PlanFile, RefusesNumbersBeyondWhatADoubleHolds) {
  const std::string text = good_plan().dump();
  for (const char* const number : {"1e999", "-1e999"}) {
    std::string bad = text;
    bad.replace(bad.find("300"), 3, number);
    const auto plan = parse_plan(bad, ".");
    ASSERT_FALSE(plan);
    EXPECT_EQ(plan.error().code, ErrorCode::kPlanInvalid);
    EXPECT_NE(plan.error().message.find("too large"), std::string::npos) << plan.error().message;
  }
}

TEST(PlanFile, RefusesAKeyThatStandsTwice) {
  const std::string text = good_plan().dump();
  const auto complaint = [&](const std::string& before, const std::string& more) {
    std::string twice = text;
    twice.insert(twice.find(before), more);
    const auto plan = parse_plan(twice, ".");
    return plan ? std::string("read") : plan.error().message;
  };
  EXPECT_EQ(complaint("\"title\"", "\"title\": \"other\", "), "key title stands twice");
  EXPECT_EQ(complaint("\"bone_hu\"", "\"bone_hu\": 500, "), "key bone_hu stands twice");
  EXPECT_EQ(complaint("\"translation_mm\"", "\"at\": 0.25, "), "key at stands twice");
}

TEST(PlanFile, SurvivesAnyDamage) {
  const std::string good = good_plan().dump();
  std::mt19937 generator(11);
  for (int i = 0; i < 3000; ++i) {
    std::string bad = good;
    for (int flips = 1 + i % 4; flips > 0; --flips)
      bad[generator() % bad.size()] = char(generator() % 128);
    if (i % 3 == 0) bad.resize(generator() % bad.size());
    const auto plan = parse_plan(bad, ".");  // Refused or harmless, never a crash.
    if (plan) {
      EXPECT_FALSE(plan->path.keyframes.empty());
    }
  }
  EXPECT_FALSE(parse_plan(std::string(100'000, '['), "."));
}

}  // namespace
}  // namespace lefort::io
