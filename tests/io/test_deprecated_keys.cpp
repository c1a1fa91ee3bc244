/// \file
/// Former names of keys in plans and decks: read with a warning, rejected beside the new name.
#include <lefort/io/deck_file.h>
#include <lefort/io/deprecated_keys.h>
#include <lefort/io/plan_file.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <set>
#include <string>

namespace lefort::io::test_deprecated_keys {
namespace {

using Json = nlohmann::json;

/// Each deprecated key of a plan, in the order of their table.
constexpr const char* kOldPlan = R"({
  "lefort_plan": 1,
  "segments": [
    {"name": "front",
     "osteotomy": {"planes": [{"point_mm": [1, 2, 3], "towards_segment": [0, -2, 0]}],
                   "also": [{"planes": [{"point_mm": [0, 0, 0], "towards_segment": [1, 0, 0]}]}],
                   "holds": [[1, 2, 3]], "smallest_piece_ml": 0.25, "smallest_piece_share": 0.125},
     "path": {"keyframes": [{"at": 0.5, "translation_mm": [0, -3, 0]}, {"at": 1}]}},
    {"name": "left", "from": "front",
     "osteotomy": {"planes": [{"point_mm": [1, 2, 3], "towards_segment": [0, -2, 0]}]},
     "path": {"keyframes": [{}]}}],
  "boundary": {"moved_bone": "attached", "scan_edge": "fixed", "release_mm": 5, "capture_mm": 0.5},
  "contact": {"reconstruction": "trilinear"},
  "solver": {"smallest_step": 0.25}
})";

constexpr const char* kOldDeck = R"({
  "lefort_deck": 1, "mesh": "block.vtu",
  "materials": [{"law": "holzapfel-gasser-ogden", "mu_kpa": 1, "k1_kpa": 2, "k2": 3, "bulk_kpa": 4,
                 "fibres": [[1, 0, 0]]}],
  "motions": [{"set": "z1", "keyframes": [{"at": 0.25}, {"at": 1}]}],
  "obstacles": [{"name": "ball", "file": "ball.stl", "faces": "z1", "capture_mm": 0.25,
                 "reconstruction": "trilinear", "keyframes": [{"at": 0.5}, {}]}],
  "steps": {"initial": 0.25, "smallest": 0.001, "largest": 0.5, "growth": 1.5,
            "easy_iterations": 4, "most_attempts": 77, "at": [0.3]},
  "output": {"every": "at"}
})";

TEST(DeprecatedKeys, PlanIsReadWithOneWarningForEachName) {
  const PlanFile plan = parse_plan(kOldPlan, ".").value();
  EXPECT_EQ(plan.segments[0].osteotomy.additional_regions.size(), 1U);
  EXPECT_EQ(plan.segments[0].osteotomy.anchor_points_L.size(), 1U);
  EXPECT_EQ(plan.segments[0].cut.min_piece_ml, 0.25);
  EXPECT_EQ(plan.segments[0].cut.min_piece_fraction, 0.125);
  EXPECT_EQ(plan.segments[0].path.keyframes[0].path_fraction, 0.5);
  EXPECT_EQ(plan.segments[1].cut_from, "front");
  EXPECT_EQ(plan.boundary.interface, predict::TissueInterface::kBonded);
  EXPECT_EQ(plan.boundary.scan_boundary, predict::OuterBoundary::kFixed);
  EXPECT_EQ(plan.boundary.elevation_margin_mm, 5.0);
  EXPECT_EQ(plan.boundary.contact_snap_mm, 0.5);
  EXPECT_EQ(plan.contact.detection, contact::DetectionMethod::kTrilinear);
  EXPECT_EQ(plan.solver.min_increment_ratio, 0.25);
  // Without segment_interface, a former name of the same key; and one value.
  ASSERT_EQ(plan.warnings.size(), deprecated_in_plans().keys.size() - 1 + 1);
  EXPECT_EQ(plan.warnings.front(), "segments[].from is deprecated, use cut_from");
  EXPECT_EQ(plan.warnings.back(), "boundary.interface: attached is deprecated, use bonded");
}

/// Both former names of boundary.interface, with their former values.
TEST(DeprecatedKeys, FormerInterfacesAreContactAndBonded) {
  struct Former {
    const char *key, *value;
    predict::TissueInterface interface;
    std::size_t warnings;
  };
  for (const auto& [key, value, interface, warnings] :
       {Former{"moved_bone", "contact", predict::TissueInterface::kContact, 1},
        Former{"moved_bone", "attached", predict::TissueInterface::kBonded, 2},
        Former{"segment_interface", "sliding", predict::TissueInterface::kContact, 2},
        Former{"segment_interface", "bonded", predict::TissueInterface::kBonded, 1}}) {
    Json json = Json::parse(rename_plan_keys(kOldPlan).value());
    json["boundary"] = {{key, value}};
    const PlanFile plan = parse_plan(json.dump(), ".").value();
    EXPECT_EQ(plan.boundary.interface, interface) << key << ": " << value;
    ASSERT_EQ(plan.warnings.size(), warnings) << key << ": " << value;
    EXPECT_EQ(plan.warnings[0], std::string("boundary.") + key + " is deprecated, use interface");
    json["boundary"]["interface"] = "clinical";
    EXPECT_FALSE(parse_plan(json.dump(), "."));
  }
}

TEST(DeprecatedKeys, DeckIsReadWithOneWarningForEachName) {
  const DeckFile file = parse_deck(kOldDeck, ".").value();
  const solve::Deck& deck = file.deck;
  EXPECT_EQ(deck.motions[0].path.keyframes[0].path_fraction, 0.25);
  EXPECT_EQ(deck.obstacles[0].contact_snap_mm, 0.25);
  EXPECT_EQ(deck.obstacles[0].path.keyframes[0].path_fraction, 0.5);
  EXPECT_EQ(deck.obstacles[0].detection, contact::DetectionMethod::kTrilinear);
  EXPECT_EQ(deck.steps.first_increment, 0.25);
  EXPECT_EQ(deck.steps.min_increment, 0.001);
  EXPECT_EQ(deck.steps.max_increment, 0.5);
  EXPECT_EQ(deck.steps.growth_factor, 1.5);
  EXPECT_EQ(deck.steps.target_iterations, 4);
  EXPECT_EQ(deck.steps.max_attempts, 77);
  EXPECT_EQ(deck.times, std::vector<double>{0.3});
  EXPECT_EQ(file.every, WriteEvery::kRequestedTime);
  ASSERT_EQ(file.warnings.size(), deprecated_in_decks().keys.size() + 1);
  EXPECT_EQ(file.warnings.back(), "output.every: at is deprecated, use times");
}

TEST(DeprecatedKeys, BothNamesOfAKeyAreRefused) {
  Json plan = Json::parse(kOldPlan);
  plan["boundary"]["contact_snap_mm"] = 0.5;
  const auto rejected = parse_plan(plan.dump(), ".");
  ASSERT_FALSE(rejected);
  EXPECT_EQ(rejected.error().code, ErrorCode::kPlanInvalid);
  EXPECT_EQ(rejected.error().message,
            "boundary.contact_snap_mm: must have one of contact_snap_mm and capture_mm, its "
            "deprecated name");
}

TEST(DeprecatedKeys, RenamedPlanReadsTheSameWithoutAWarning) {
  const std::string renamed = rename_plan_keys(kOldPlan).value();
  const PlanFile plan = parse_plan(renamed, ".").value();
  EXPECT_TRUE(plan.warnings.empty());
  EXPECT_EQ(plan.boundary.elevation_margin_mm, 5.0);
  EXPECT_EQ(plan.segments[0].path.keyframes[0].path_fraction, 0.5);
  EXPECT_EQ(rename_plan_keys(renamed).value(), renamed);
  EXPECT_EQ(rename_plan_keys("{").error().code, ErrorCode::kPlanInvalid);
}

TEST(DeprecatedKeys, NoOldNameOccursTwiceOrIsANewName) {
  for (const DeprecatedNames& names : {deprecated_in_plans(), deprecated_in_decks()}) {
    std::set<std::string> old_keys, new_keys;  // A key may have had several names.
    const auto path = [](const DeprecatedKey& name, std::string_view key) {
      return std::string(name.object) + "/" + std::string(key);
    };
    for (const DeprecatedKey& name : names.keys) {
      EXPECT_TRUE(old_keys.insert(path(name, name.old_key)).second) << name.old_key;
      new_keys.insert(path(name, name.new_key));
    }
    for (const std::string& key : old_keys) EXPECT_FALSE(new_keys.contains(key)) << key;
  }
}

}  // namespace
}  // namespace lefort::io::test_deprecated_keys
