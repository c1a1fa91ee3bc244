#include <lefort/geometry/rigid_motion.h>
#include <lefort/geometry/rigid_path.h>
#include <lefort/io/plan_file.h>
#include <lefort/io/plan_inputs.h>
#include <lefort/io/transform_file.h>
#include <lefort/io/write_atomically.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <filesystem>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "support/temporary_folder.h"

namespace lefort::io::test_plan_file {
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
                    "min_piece_ml": 0.25, "min_piece_fraction": 0.125},
      "path": {"steps": 7, "keyframes": [
        {"path_fraction": 0.5, "translation_mm": [0, -3, 0]},
        {"path_fraction": 1, "translation_mm": [0, -6, -1], "rotation_deg": [0, 0, 90],
         "about_mm": [4, 5, 6]}]}
    }],
    "tissue": {"material": {"law": "neo-hookean", "young_kpa": 20, "poisson": 0.4},
               "element_size_mm": 3},
    "boundary": {"interface": "bonded", "scan_boundary": "fixed", "cut_boundary": "foundation",
                 "foundation_mm": 30, "elevation_margin_mm": 5, "joint_margin_mm": 6,
                 "vestibule_mm": 8, "lip_tone_kpa": 2, "interface_layer_mm": 0.5, "contact_snap_mm": 0.7, "lips": "joined",
                 "labels": "painted.seg.nrrd"},
    "contact": {"stiffness_factor": 30, "obstacle": "bone", "detection": "bvh",
                "integration": "weighted", "penetration_tolerance_mm": null},
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
  ASSERT_EQ(plan.segments.size(), 1U);
  EXPECT_EQ(plan.segments[0].osteotomy.segment, "midface");
  ASSERT_EQ(plan.segments[0].osteotomy.planes.size(), 1U);
  EXPECT_EQ(plan.segments[0].osteotomy.planes[0].point_L, Vec3(1.0, 2.0, 3.0));
  EXPECT_EQ(plan.segments[0].osteotomy.planes[0].normal_L, Vec3(0.0, -1.0, 0.0));
  EXPECT_EQ(plan.segments[0].cut.min_piece_ml, 0.25);
  EXPECT_EQ(plan.segments[0].cut.min_piece_fraction, 0.125);
  EXPECT_EQ(plan.segments[0].path.steps, 7);
  ASSERT_EQ(plan.segments[0].path.keyframes.size(), 2U);
  EXPECT_EQ(plan.segments[0].path.keyframes[1].translation_mm, Vec3(0.0, -6.0, -1.0));
  EXPECT_NEAR(plan.segments[0].path.keyframes[1].rotation_rad.z(), std::numbers::pi / 2.0, 1e-15);
  EXPECT_EQ(plan.segments[0].path.keyframes[1].center_L, Vec3(4.0, 5.0, 6.0));
  EXPECT_NEAR(plan.tissue.young_mpa, 0.02, 1e-15);
  EXPECT_EQ(plan.tissue.poisson, 0.4);
  EXPECT_EQ(plan.tissue.element_size_mm, 3.0);
  EXPECT_EQ(plan.boundary.interface, predict::TissueInterface::kBonded);
  EXPECT_EQ(plan.boundary.scan_boundary, predict::OuterBoundary::kFixed);
  EXPECT_EQ(plan.boundary.cut_boundary, predict::OuterBoundary::kFoundation);
  EXPECT_EQ(plan.boundary.foundation_mm, 30.0);
  EXPECT_EQ(plan.boundary.elevation_margin_mm, 5.0);
  EXPECT_EQ(plan.boundary.joint_margin_mm, 6.0);
  EXPECT_EQ(plan.boundary.vestibule_mm, 8.0);
  EXPECT_EQ(plan.boundary.lip_tone_mpa, 0.002);
  EXPECT_EQ(plan.boundary.interface_layer_mm, 0.5);
  EXPECT_EQ(plan.boundary.contact_snap_mm, 0.7);
  EXPECT_EQ(plan.boundary.lips, predict::Lips::kJoined);
  EXPECT_EQ(plan.boundary_labels, std::filesystem::path("/cases/one/painted.seg.nrrd"));
  EXPECT_EQ(plan.contact.stiffness_factor, 30.0);
  EXPECT_EQ(plan.contact.obstacle, predict::Obstacle::kBone);
  EXPECT_EQ(plan.contact.detection, contact::DetectionMethod::kBvh);
  EXPECT_EQ(plan.contact.integration, contact::Integration::kWeighted);
  EXPECT_FALSE(plan.contact.penetration_tolerance_mm);
  EXPECT_EQ(plan.field.resolution, 64);
  EXPECT_EQ(plan.field.band_mm, 4.0);
  EXPECT_EQ(plan.solver.relative_tolerance, 1e-7);
  EXPECT_EQ(plan.solver.max_iterations, 12);
}

TEST(PlanFile, IsCheckedWithAndWithoutItsFiles) {
  Json plan = good_plan();
  EXPECT_TRUE(check_plan_form(plan.dump()));
  EXPECT_TRUE(check_plan(plan.dump(), "/cases/one").value().empty());
  plan["landmarks"] = "missing.csv";
  EXPECT_TRUE(check_plan_form(plan.dump()));
  EXPECT_EQ(check_plan(plan.dump(), "/cases/one").error().code, ErrorCode::kFileNotFound);
  plan["landmarks"] = "auto";  // Found in the scan, which is not read here.
  EXPECT_TRUE(check_plan(plan.dump(), "/cases/one"));
  plan["tissue"]["hue"] = 1;
  for (const std::string& message :
       {check_plan_form(plan.dump()).error().message, check_plan(plan.dump(), "/").error().message})
    EXPECT_EQ(message, "tissue: unknown key 'hue'.");
}

TEST(PlanFile, WhatIsNotSaidHasItsDefault) {
  Json json = good_plan();
  for (const char* key : {"ct", "segmentation", "tissue", "boundary", "contact", "field", "solver"})
    json.erase(key);
  const PlanFile plan = parse_plan(json.dump(), ".").value();
  EXPECT_FALSE(plan.ct);
  EXPECT_FALSE(plan.boundary_labels);
  EXPECT_EQ(plan.tissue.poisson, predict::TissueOptions{}.poisson);
  EXPECT_EQ(plan.boundary.interface, predict::TissueInterface::kClinical);
  EXPECT_EQ(plan.boundary.scan_boundary, predict::OuterBoundary::kRoller);
  EXPECT_EQ(plan.boundary.cut_boundary, predict::OuterBoundary::kRoller);
  EXPECT_FALSE(plan.boundary.elevation_margin_mm);
}

TEST(PlanFile, EachNameOfAnInterfaceAndOfABoundaryIsRead) {
  Json json = good_plan();
  const auto boundary = [&](const char* key, std::string_view name) {
    json["boundary"] = {{key, name}};
    return parse_plan(json.dump(), ".").value().boundary;
  };
  using predict::OuterBoundary;
  using predict::TissueInterface;
  for (const auto interface :
       {TissueInterface::kClinical, TissueInterface::kBonded, TissueInterface::kContact})
    EXPECT_EQ(boundary("interface", name_of(interface)).interface, interface);
  for (const auto outer : {OuterBoundary::kRoller, OuterBoundary::kFree, OuterBoundary::kFixed,
                           OuterBoundary::kFoundation}) {
    EXPECT_EQ(boundary("scan_boundary", name_of(outer)).scan_boundary, outer);
    EXPECT_EQ(boundary("cut_boundary", name_of(outer)).cut_boundary, outer);
  }
  for (const char* key : {"interface", "scan_boundary", "cut_boundary"}) {
    json["boundary"] = {{key, "slippery"}};
    EXPECT_EQ(parse_plan(json.dump(), ".").error().code, ErrorCode::kPlanInvalid);
  }
  for (const char* key : {"foundation_mm", "interface_layer_mm"}) {
    json["boundary"] = {{key, 0.0}};
    EXPECT_EQ(parse_plan(json.dump(), ".").error().code, ErrorCode::kPlanInvalid);
  }
}

TEST(PlanFile, MucosaAndLipsAndNoseAreThereOnlyIfTheyAreRequested) {
  Json json = good_plan();
  const auto tissue = [&] { return parse_plan(json.dump(), ".").value().tissue; };
  EXPECT_FALSE(tissue().mucosa);
  EXPECT_FALSE(tissue().face);
  json["tissue"]["mucosa"] = {
      {"thickness_mm", 1.5},
      {"material", {{"law", "neo-hookean"}, {"young_kpa", 40}, {"poisson", 0.3}}}};
  json["tissue"]["lips_and_nose_element_size_mm"] = 1.25;
  json["landmarks"] = {{"Prn", {1, -20, 3}}, {"A", {0, 0, 0}}, {"Ls", {2, -19, -4}}};
  EXPECT_EQ(tissue().mucosa->thickness_mm, 1.5);
  EXPECT_NEAR(tissue().mucosa->young_mpa, 0.04, 1e-15);
  EXPECT_EQ(tissue().mucosa->poisson, 0.3);
  EXPECT_EQ(tissue().face->element_size_mm, 1.25);
  EXPECT_EQ(tissue().face->points_L, (std::vector<Vec3>{{1, -20, 3}, {2, -19, -4}}));
  json["tissue"]["mucosa"].erase("material");
  EXPECT_FALSE(parse_plan(json.dump(), "."));
  json["tissue"].erase("mucosa");
  json["tissue"]["lips_and_nose_element_size_mm"] = 19.5;
  const auto coarse = parse_plan(json.dump(), ".");
  ASSERT_FALSE(coarse);
  EXPECT_NE(coarse.error().message.find("lips_and_nose_element_size_mm: 19.5 is more than"),
            std::string::npos);
}

TEST(PlanFile, MuscleIsThereOnlyIfItIsRequestedAndHasAMaterial) {
  Json json = good_plan();
  EXPECT_FALSE(parse_plan(json.dump(), ".").value().tissue.muscle);
  json["tissue"]["muscle"] = {
      {"material", {{"law", "neo-hookean"}, {"young_kpa", 60}, {"poisson", 0.4}}}};
  const predict::TissueOptions tissue = parse_plan(json.dump(), ".").value().tissue;
  EXPECT_NEAR(tissue.muscle->young_mpa, 0.06, 1e-15);
  EXPECT_EQ(tissue.muscle->poisson, 0.4);
  EXPECT_NEAR(tissue.young_mpa, 0.02, 1e-15);
  json["tissue"]["muscle"]["thickness_mm"] = 2;
  EXPECT_FALSE(parse_plan(json.dump(), "."));
  json["tissue"]["muscle"] = Json::object();
  EXPECT_NE(parse_plan(json.dump(), ".").error().message.find("tissue.muscle"), std::string::npos);
  json["tissue"]["muscle"] = {{"material", "stone"}};
  EXPECT_NE(parse_plan(json.dump(), ".").error().message.find("tissue.muscle.material"),
            std::string::npos);
}

TEST(PlanFile, SkinIsThereOnlyIfItIsRequested) {
  Json json = good_plan();
  EXPECT_FALSE(parse_plan(json.dump(), ".").value().tissue.skin);
  json["tissue"]["skin"] = Json::object();
  const predict::SkinOptions defaults;
  const auto skin = parse_plan(json.dump(), ".").value().tissue.skin;
  ASSERT_TRUE(skin);
  EXPECT_EQ(skin->thickness_mm, defaults.thickness_mm);
  EXPECT_EQ(skin->layers, defaults.layers);
  EXPECT_EQ(skin->young_mpa, defaults.young_mpa);
  json["tissue"]["skin"] = {
      {"thickness_mm", 1.8},
      {"layers", 3},
      {"material", {{"law", "neo-hookean"}, {"young_kpa", 40}, {"poisson", 0.3}}}};
  const predict::TissueOptions all = parse_plan(json.dump(), ".").value().tissue;
  EXPECT_EQ(all.skin->thickness_mm, 1.8);
  EXPECT_EQ(all.skin->layers, 3);
  EXPECT_NEAR(all.skin->young_mpa, 0.04, 1e-15);
  EXPECT_EQ(all.skin->poisson, 0.3);
  EXPECT_NEAR(all.young_mpa, 0.02, 1e-15);
  json["tissue"]["skin"]["material"] = "skin-barbarino-2011";
  EXPECT_EQ(parse_plan(json.dump(), ".").value().tissue.skin->young_mpa, defaults.young_mpa);
}

TEST(PlanFile, CoarseElementsAloneMakeTheRimAsCoarse) {
  Json json = good_plan();
  json["tissue"]["element_size_mm"] = 9;
  EXPECT_EQ(parse_plan(json.dump(), ".").value().tissue.far_element_size_mm, 9.0);
}

/// Landmarks, and segments cut and moved in all the other ways.
Json rich_plan() {
  return Json::parse(R"({
    "lefort_plan": 1,
    "landmarks": {"N": [0, -66, 30], "ANS": [0, -70, -25], "PNS": [0, -25, -28], "Or-R": [-32, -55, 2],
                  "Or-L": [32, -55, 2]},
    "segments": [
      {"name": "maxilla",
       "osteotomy": {"template": {"kind": "le-fort-1", "above_palate_mm": 7}, "kerf_mm": 0.5},
       "path": {"interpolation": "screw", "keyframes": [
         {"path_fraction": 0.5, "translation_mm": [0, -2, 0], "rotation_deg": [5, 0, 0],
          "about": "PNS"},
         {"targets": {"ANS": [0, -75, -25], "PNS": [0, -30, -28], "N": [0, -71, 30]}}]}},
      {"name": "right", "cut_from": "maxilla",
       "osteotomy": {"curves": [{"points_mm": [[0, 0, 0], [0, 9, 0], [0, 0, 9]], "along": [-2, 0, 0],
                                 "depth_mm": 12}],
                     "additional_regions": [
                       {"planes": [{"point_mm": [0, 0, 0], "towards_segment": [1, 0, 0]}]}],
                     "anchor_points": ["ANS", [1, 2, 3]]},
       "path": {"distraction": [{"towards": [0, -3, 0], "mm_per_day": 0.5, "days": 8}]}},
      {"name": "chin",
       "osteotomy": {"planes": [{"point_mm": [0, 0, 0], "towards_segment": [0, 0, -2],
                                 "size_mm": [30, 20], "across": [2, 0, 0]}]},
       "path": {"keyframes": [{"translation_mm": [0, -4, 0]}]}}]
  })");
}

TEST(PlanFile, SegmentsAreCutAndMovedInEveryWay) {
  const auto plan = parse_plan(rich_plan().dump(), ".");
  ASSERT_TRUE(plan) << plan.error().message;
  EXPECT_EQ(plan->landmarks.size(), 5U);
  ASSERT_EQ(plan->segments.size(), 3U);
  const auto& [maxilla, maxilla_cut, maxilla_from, maxilla_path, is_distracted, is_whole, piece] =
      plan->segments[0];
  EXPECT_EQ(maxilla.segment, "maxilla");
  EXPECT_EQ(maxilla.kerf_mm, 0.5);
  EXPECT_EQ(maxilla.procedure, plan::OsteotomyTemplate::kLeFort1);
  EXPECT_EQ(maxilla.planes.size(), 2U);
  EXPECT_NEAR((maxilla.planes[0].point_L - Vec3(0, -70, -25)).norm(), 7.0, 1e-12);
  EXPECT_EQ(maxilla_from, "");
  EXPECT_FALSE(is_distracted || is_whole || piece);
  EXPECT_EQ(maxilla_path.interpolation, geometry::Interpolation::kScrew);
  EXPECT_EQ(maxilla_path.keyframes[0].center_L, Vec3(0, -25, -28));
  EXPECT_LT((maxilla_path.keyframes[1].translation_mm - Vec3(0, -5, 0)).norm(), 1e-9);
  EXPECT_EQ(maxilla_path.keyframes[1].path_fraction, 1.0);

  const plan::PlannedSegment& right = plan->segments[1];
  EXPECT_EQ(right.cut_from, "maxilla");
  EXPECT_FALSE(right.osteotomy.procedure);
  EXPECT_EQ(right.osteotomy.curves[0].direction_L, Vec3(-1, 0, 0));
  EXPECT_EQ(right.osteotomy.curves[0].depth_mm, 12.0);
  EXPECT_EQ(right.osteotomy.additional_regions.size(), 1U);
  ASSERT_EQ(right.osteotomy.anchor_points_L.size(), 2U);
  EXPECT_EQ(right.osteotomy.anchor_points_L[0], Vec3(0, -70, -25));
  EXPECT_TRUE(right.is_distracted);
  EXPECT_EQ(right.path.steps, 8);
  EXPECT_EQ(right.path.keyframes[0].translation_mm, Vec3(0, -4, 0));

  ASSERT_TRUE(plan->segments[2].osteotomy.planes[0].bounds);
  EXPECT_EQ(plan->segments[2].osteotomy.planes[0].bounds->width_mm, 30.0);
  EXPECT_EQ(plan->segments[2].osteotomy.planes[0].bounds->across_L, Vec3(1, 0, 0));
}

Json autorotated_plan() {
  return Json::parse(R"({
    "lefort_plan": 1,
    "landmarks": {"Cdl-R": [-60, 10, -4], "Cdm-R": [-40, 10, -4], "Cdl-L": [60, 10, -4],
                  "Cdm-L": [40, 10, -4]},
    "segments": [
      {"name": "distal", "osteotomy": {"planes": [{"point_mm": [0, 0, 0], "towards_segment": [0, -1, 0]}]},
       "path": {"keyframes": [{"autorotate": {"closing_deg": 5}, "translation_mm": [0, 3, 0]}]}},
      {"name": "proximal", "osteotomy": {"piece_at": "Cdl-R"},
       "path": {"keyframes": [{"rotation_deg": [-2, 0, 0], "about": "condyle-R"}]}}]
  })");
}

/// Both about the axis x through (10, -4); the closed form of a rotation in its normal plane.
TEST(PlanFile, AMandibleRotatesAboutItsCondyles) {
  const auto plan = parse_plan(autorotated_plan().dump(), ".");
  ASSERT_TRUE(plan) << plan.error().message;
  const auto turned = [](double y, double z, double closing_deg) {
    const double a = -closing_deg * std::numbers::pi / 180.0;
    return Vec3(7, 10 + std::cos(a) * (y - 10) - std::sin(a) * (z + 4),
                -4 + std::sin(a) * (y - 10) + std::cos(a) * (z + 4));
  };
  const RigidTransform distal = geometry::pose_at(plan->segments[0].path, 1.0);
  EXPECT_LT((distal * Vec3(7, -70, -64) - turned(-70, -64, 5.0) - Vec3(0, 3, 0)).norm(), 1e-12);
  EXPECT_EQ(plan->segments[1].piece_at_L, Vec3(-60, 10, -4));
  EXPECT_FALSE(plan->segments[0].piece_at_L);
  const RigidTransform proximal = geometry::pose_at(plan->segments[1].path, 1.0);
  EXPECT_EQ(plan->segments[1].path.keyframes[0].center_L, Vec3(-50, 10, -4));
  EXPECT_LT((proximal * Vec3(7, 15, -60) - turned(15, -60, 2.0)).norm(), 1e-12);
}

/// A gap is replaced by an angle once the scan is known.
TEST(PlanFile, AGapBecomesAnAngle) {
  Json json = autorotated_plan();
  json["segments"][0]["path"]["keyframes"][0]["autorotate"] = {{"gap_mm", 0.5}, {"to", "maxilla"}};
  const auto gaps = jaw_gaps(json.dump());
  ASSERT_EQ(gaps.size(), 1U);
  EXPECT_EQ(gaps[0].segment, 0U);
  EXPECT_EQ(gaps[0].keyframe, 0U);
  EXPECT_EQ(gaps[0].gap_mm, 0.5);
  EXPECT_EQ(gaps[0].upper_jaw, "maxilla");
  const Json closed = Json::parse(with_closing(json.dump(), gaps[0], 5.0));
  EXPECT_EQ(closed, autorotated_plan());
  EXPECT_TRUE(jaw_gaps(closed.dump()).empty());
  json["segments"][0]["path"]["keyframes"][0]["autorotate"] = {{"as", "distal"}};
  const auto same = jaw_gaps(json.dump());
  ASSERT_EQ(same.size(), 1U);
  EXPECT_EQ(same[0].as, "distal");
  EXPECT_EQ(Json::parse(with_closing(json.dump(), same[0], 5.0)), autorotated_plan());
}

TEST(PlanFile, AutorotationWithoutItsAxisIsRejected) {
  const auto refused = [](const std::function<void(Json&)>& change, const std::string& says) {
    Json json = autorotated_plan();
    change(json);
    const auto plan = parse_plan(json.dump(), ".");
    ASSERT_FALSE(plan) << says;
    EXPECT_EQ(plan.error().code, ErrorCode::kPlanInvalid);
    EXPECT_NE(plan.error().message.find(says), std::string::npos) << plan.error().message;
  };
  refused([](Json& j) { j["landmarks"].erase("Cdm-L"); }, "Cdm-L");
  refused(
      [](Json& j) {
        j["landmarks"].erase("Cdm-L");
        j["segments"].erase(0);
      },
      "Cdm-L");
  auto frame = [](Json& j) -> Json& { return j["segments"][0]["path"]["keyframes"][0]; };
  refused([&](Json& j) { frame(j)["autorotate"]["closing_deg"] = 31; }, "closing_deg");
  refused([&](Json& j) { frame(j)["autorotate"] = Json::object(); }, "closing_deg");
  refused([&](Json& j) { frame(j)["autorotate"] = {{"gap_mm", 1}}; }, "with a scan");
  refused([&](Json& j) { frame(j)["autorotate"]["gap_mm"] = 1; }, "either closing_deg or gap_mm");
  refused([&](Json& j) { frame(j)["autorotate"] = {{"as", "distal"}}; }, "with a scan");
  refused([&](Json& j) { frame(j)["autorotate"]["as"] = "distal"; }, "or as");
  refused([&](Json& j) { frame(j)["autorotate"]["to"] = "x"; }, "to is of gap_mm");
  auto cut = [](Json& j) -> Json& { return j["segments"][1]["osteotomy"]; };
  refused([&](Json& j) { cut(j)["bone"] = "mandible"; }, "bone and piece_at move a whole bone");
  refused([&](Json& j) { cut(j)["kerf_mm"] = 1; }, "bone and piece_at move a whole bone");
  refused([&](Json& j) { cut(j)["piece_at"] = "Cdl"; }, "no landmark Cdl");
  refused(
      [&](Json& j) {
        frame(j).erase("translation_mm");
        frame(j)["targets"] = {
            {"Cdl-R", {-60, 10, -4}}, {"Cdm-R", {-40, 10, -4}}, {"Cdl-L", {60, 12, -4}}};
      },
      "autorotate excludes");
}

TEST(PlanFile, NamedFilesAreReadFromThePlansFolder) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_text(folder / "points.csv", "name,x_mm,y_mm,z_mm\nANS,1,2,3\n"));
  ASSERT_TRUE(write_text(folder / "move.tfm",
                         "#Insight Transform File V1.0\n#Transform 0\n"
                         "Transform: AffineTransform_double_3_3\n"
                         "Parameters: 1 0 0 0 1 0 0 0 1 0 10 0\nFixedParameters: 0 0 0\n"));
  ASSERT_TRUE(write_text(
      folder / "curve.mrk.json",
      R"({"markups": [{"type": "ClosedCurve", "coordinateSystem": "RAS", "controlPoints": [
        {"position": [0, 0, 0]}, {"position": [9, 0, 0]}, {"position": [0, 9, 0]}]}]})"));
  Json json = good_plan();
  json["landmarks"] = "points.csv";
  json["segments"][0]["osteotomy"] = {
      {"curves", {{{"file", "curve.mrk.json"}, {"along", {0, 0, 1}}}}}};
  json["segments"][0]["path"] = {{"keyframes", {{{"transform", "move.tfm"}, {"about", "ANS"}}}}};
  ASSERT_TRUE(write_text(folder / "plan.json", json.dump()));
  const auto plan = read_plan(folder / "plan.json");
  ASSERT_TRUE(plan) << plan.error().message;
  const plan::PlannedSegment& segment = plan->segments[0];
  EXPECT_LT((segment.path.keyframes[0].translation_mm - Vec3(0, -10, 0)).norm(), 1e-12);
  EXPECT_EQ(segment.path.keyframes[0].center_L, Vec3(1, 2, 3));
  EXPECT_EQ(segment.osteotomy.curves[0].points_L[1], Vec3(-9, 0, 0));
  std::filesystem::remove(folder / "move.tfm");
  const auto missing = read_plan(folder / "plan.json");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::kFileNotFound);
  EXPECT_NE(missing.error().message.find("move.tfm"), std::string::npos) << missing.error().message;
}

/// A plane drawn in Slicer cuts as it is drawn: which side is the segment's is the normal's say.
TEST(PlanFile, PlanesMayComeFromSlicer) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_text(folder / "cuts.mrk.json", R"({"markups": [
    {"type": "Plane", "name": "coronal", "coordinateSystem": "LPS",
     "center": [1, 2, 3], "normal": [0, -2, 0], "orientation": [1, 0, 0, 0, 0, -1, 0, 1, 0],
     "size": [40, 30, 0]},
    {"type": "Plane", "name": "axial", "coordinateSystem": "RAS", "center": [1, 2, 3],
     "normal": [0, 1, 1]},
    {"type": "Plane", "name": "old", "controlPoints": [{"position": [0, 0, 0]}]}]})"));
  const auto read = [&](const Json& plane) {
    Json json = good_plan();
    json["segments"][0]["osteotomy"] = {{"planes", {plane}}};
    return parse_plan(json.dump(), folder.path());
  };
  const auto cut = [&](const Json& plane) {
    const auto plan = read(plane);
    EXPECT_TRUE(plan) << plan.error().message;
    return plan->segments[0].osteotomy.planes[0];
  };
  const plan::CutPlane coronal = cut({{"file", "cuts.mrk.json"}, {"name", "coronal"}});
  EXPECT_EQ(coronal.point_L, Vec3(1, 2, 3));
  EXPECT_EQ(coronal.normal_L, Vec3(0, -1, 0));
  EXPECT_FALSE(coronal.bounds);
  const plan::CutPlane bounded =
      cut({{"file", "cuts.mrk.json"}, {"name", "coronal"}, {"flip", true}, {"bounded", true}});
  EXPECT_EQ(bounded.normal_L, Vec3(0, 1, 0));
  ASSERT_TRUE(bounded.bounds);
  EXPECT_EQ(bounded.bounds->across_L, Vec3(1, 0, 0));
  EXPECT_EQ(bounded.bounds->width_mm, 40.0);
  EXPECT_EQ(bounded.bounds->height_mm, 30.0);
  const plan::CutPlane axial = cut({{"file", "cuts.mrk.json"}, {"name", "axial"}});
  EXPECT_EQ(axial.point_L, Vec3(-1, -2, 3));
  EXPECT_LT((axial.normal_L - Vec3(0, -1, 1).normalized()).norm(), 1e-15);

  const auto refuse = [&](const Json& plane, const char* words) {
    const auto plan = read(plane);
    ASSERT_FALSE(plan) << words;
    EXPECT_NE(plan.error().message.find(words), std::string::npos) << plan.error().message;
    EXPECT_NE(plan.error().message.find("osteotomy.planes[0]"), std::string::npos);
  };
  const Json file{{"file", "cuts.mrk.json"}};
  const auto with = [](Json json, const char* key, const Json& value) {
    json[key] = value;
    return json;
  };
  refuse(file, "several planes, must be one");
  refuse(with(file, "name", "sagittal"), "no plane of that name");
  refuse(with(file, "name", "old"), "no center and normal");
  refuse(with(with(file, "name", "axial"), "bounded", true), "no size");
  refuse(with(file, "point_mm", {0, 0, 0}), "file and point_mm stand together");
  refuse({{"point_mm", {0, 0, 0}}, {"towards_segment", {0, 0, 1}}, {"flip", true}},
         "flip is of planes from a file");
  refuse({{"point_mm", {0, 0, 0}}}, "must have either point_mm and towards_segment, or file");
}

/// Slicer's center is the scan's origin; a pitch there would be reported as a translation of the maxilla.
TEST(PlanFile, ATransformIsAboutWhatTheSegmentHolds) {
  const test::TemporaryFolder folder;
  const RigidTransform X_LB = geometry::rigid_motion(Vec3::Zero(), {0.17, 0, 0}, {0, 60, 20});
  ASSERT_TRUE(write_transform(folder / "pitch.tfm", X_LB));
  Json json = good_plan();
  json["segments"][0]["path"] = {{"keyframes", {{{"transform", "pitch.tfm"}}}}};
  const auto without = parse_plan(json.dump(), folder.path());
  ASSERT_FALSE(without);
  EXPECT_EQ(without.error().code, ErrorCode::kPlanInvalid);
  EXPECT_NE(without.error().message.find("a transform needs about"), std::string::npos)
      << without.error().message;
  json["segments"][0]["osteotomy"]["anchor_points"] = {{-10, 60, 20}, {10, 60, 20}};
  const auto plan = parse_plan(json.dump(), folder.path());
  ASSERT_TRUE(plan) << plan.error().message;
  const geometry::Keyframe& key = plan->segments[0].path.keyframes[0];
  EXPECT_EQ(key.center_L, Vec3(0, 60, 20));
  EXPECT_LT(key.translation_mm.norm(), 1e-12);
  EXPECT_LT((geometry::pose_at(plan->segments[0].path, 1.0).matrix() - X_LB.matrix()).norm(),
            1e-12);
}

TEST(PlanFile, LandmarksOfThePlanAreChecked) {
  const auto refuse = [](const Json& landmarks, const char* words) {
    Json json = good_plan();
    json["landmarks"] = landmarks;
    const auto plan = parse_plan(json.dump(), ".");
    ASSERT_FALSE(plan) << words;
    EXPECT_EQ(plan.error().code, ErrorCode::kPlanInvalid);
    EXPECT_NE(plan.error().message.find(words), std::string::npos) << plan.error().message;
  };
  refuse({{"Or-R", {30, 0, 0}}, {"Or-L", {-30, 0, 0}}}, "Or-R and Or-L");
  refuse({{"", {30, 0, 0}}}, "has no name");
  refuse({{"A\nB", {30, 0, 0}}}, "control characters");
}

TEST(PlanFile, ACurveFileHasItsLimit) {
  const test::TemporaryFolder folder;
  Json points = Json::array();
  for (int i = 0; i <= 1000; ++i)
    points.push_back({{"position", {40 * std::cos(i / 160.0), 40 * std::sin(i / 160.0), 0}}});
  const auto read = [&] {
    EXPECT_TRUE(write_text(
        folder / "curve.mrk.json",
        Json{{"markups", {{{"type", "ClosedCurve"}, {"controlPoints", points}}}}}.dump()));
    Json json = good_plan();
    json["segments"][0]["osteotomy"] = {
        {"curves", {{{"file", "curve.mrk.json"}, {"along", {0, 0, 1}}}}}};
    return parse_plan(json.dump(), folder.path());
  };
  const auto refused = read();
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("1001 points, at most 1000"), std::string::npos)
      << refused.error().message;
  points.erase(1000);
  const auto plan = read();
  EXPECT_TRUE(plan) << plan.error().message;
}

TEST(PlanFile, WhatContradictsItselfIsNamedByItsKey) {
  const auto refuse = [](const std::function<void(Json&)>& spoil, const char* words) {
    Json json = rich_plan();
    spoil(json["segments"]);
    const auto plan = parse_plan(json.dump(), ".");
    ASSERT_FALSE(plan) << words;
    EXPECT_EQ(plan.error().code, ErrorCode::kPlanInvalid);
    EXPECT_NE(plan.error().message.find(words), std::string::npos) << plan.error().message;
    EXPECT_EQ(plan.error().message.find('\n'), std::string::npos);
  };
  refuse([](Json& s) { s[0]["osteotomy"]["planes"] = s[2]["osteotomy"]["planes"]; },
         "segments[0].osteotomy: a template excludes planes");
  refuse([](Json& s) { s[0]["osteotomy"]["template"] = "le-fort-9"; }, "template");
  refuse([](Json& s) { s[0]["osteotomy"]["template"] = "le-fort-3"; }, "landmark FZ-R");
  refuse([](Json& s) { s[1]["osteotomy"].erase("curves"); },
         "segments[1].osteotomy: must have planes, curves, a template or a bone");
  refuse([](Json& s) { s[1]["osteotomy"]["anchor_points"] = {"Me"}; },
         "segments[1].osteotomy.anchor_points: the plan has no landmark Me");
  refuse(
      [](Json& s) {
        s[1]["osteotomy"]["curves"][0]["along"] = {0, 0, 0};
      },
      "segments[1].osteotomy.curves[0].along: the vector is zero");
  refuse([](Json& s) { s[1]["osteotomy"]["curves"][0]["file"] = "c.mrk.json"; },
         "segments[1].osteotomy.curves[0]: must have either points_mm or file");
  refuse([](Json& s) { s[2]["osteotomy"]["planes"][0].erase("across"); },
         "segments[2].osteotomy.planes[0]: size_mm and across");
  refuse([](Json& s) { s[2]["name"] = "maxilla"; }, "two segments are called 'maxilla'");
  refuse([](Json& s) { s[1]["cut_from"] = "chin"; }, "is cut from 'chin'");
  refuse([](Json& s) { s[1]["path"]["keyframes"] = s[2]["path"]["keyframes"]; },
         "segments[1].path: must have either keyframes or distraction");
  refuse(
      [](Json& s) {
        s[0]["path"]["keyframes"][1]["translation_mm"] = {0, 0, 0};
      },
      "segments[0].path.keyframes[1]: must have one of targets");
  refuse(
      [](Json& s) {
        s[0]["path"]["keyframes"][1]["targets"]["N"] = {0, -60, 50};
      },
      "segments[0].path.keyframes[1]: no rigid motion");
  refuse([](Json& s) { s[0]["path"]["keyframes"][0]["about"] = "Me"; },
         "segments[0].path.keyframes[0].about: the plan has no landmark Me");
  refuse([](Json& s) { s[1]["path"]["distraction"][0]["days"] = 0; },
         "segments[1].path.distraction[0].days");
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
        BadPlan{"UnknownKey", [](Json& j) { j["tissue"]["color"] = 1; },
                "tissue: unknown key 'color'"},
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
                [](Json& j) { j["segments"][0]["path"]["keyframes"][1]["path_fraction"] = 0.4; },
                "midface"},
        BadPlan{"OutOfRange", [](Json& j) { j["tissue"]["element_size_mm"] = -1; },
                "tissue.element_size_mm"},
        BadPlan{"FinerAtTheRim", [](Json& j) { j["tissue"]["far_element_size_mm"] = 2; },
                "tissue.far_element_size_mm: 2 is less than element_size_mm, 3"},
        BadPlan{"PascalsForKilopascals",
                [](Json& j) { j["tissue"]["material"]["young_kpa"] = 1e-3; },
                "tissue.material.young_kpa"},
        BadPlan{"PiecesOfOverAWhole",
                [](Json& j) { j["segments"][0]["osteotomy"]["min_piece_fraction"] = 1.5; },
                "segments[0].osteotomy.min_piece_fraction"},
        BadPlan{"Incompressible", [](Json& j) { j["tissue"]["material"]["poisson"] = 0.5; },
                "tissue.material.poisson"},
        BadPlan{"UnknownMaterial", [](Json& j) { j["tissue"]["material"] = "stone"; },
                "tissue.material"},
        BadPlan{"ThickSkin",
                [](Json& j) {
                  j["tissue"]["skin"] = {{"thickness_mm", 15}};
                },
                "tissue.skin.thickness_mm"},
        BadPlan{"HalfALayer",
                [](Json& j) {
                  j["tissue"]["skin"] = {{"layers", 1.5}};
                },
                "tissue.skin.layers"},
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
  EXPECT_EQ(complaint("\"translation_mm\"", "\"path_fraction\": 0.25, "),
            "key path_fraction stands twice");
}

TEST(PlanFile, RefusesMoreValuesThanTheirComplaintsHaveRoomFor) {
  const auto complaint = [](int values) {
    std::string many = "[1";
    for (int n = 1; n < values; ++n) many += ",1";
    return parse_plan(R"({"lefort_plan": 1, "segments": )" + many + "]}", ".").error().message;
  };
  EXPECT_EQ(complaint(999'990).find("more than"), std::string::npos);
  EXPECT_EQ(complaint(1'000'000), "more than 1000000 values, must be less");
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
      EXPECT_FALSE(plan->segments[0].path.keyframes.empty());
    }
  }
  EXPECT_FALSE(parse_plan(std::string(100'000, '['), "."));
}

TEST(PlanFile, TeethAreNoneAutoOrAFileThatThePlanNames) {
  const auto plan_with = [](const std::string& segmentation) {
    return R"({"lefort_plan": 1, "segmentation": )" + segmentation + R"(,
               "segments": [{"name": "midface",
                 "osteotomy": {"planes": [{"point_mm": [1, 2, 3], "towards_segment": [0, -2, 0]}]},
                 "path": {"keyframes": [{"translation_mm": [0, -6, 0]}]}}]})";
  };
  const std::string none = plan_with("{}"), automatic = plan_with(R"({"teeth": "auto"})"),
                    file = plan_with(R"({"teeth": "head/teeth.seg.nrrd"})");
  EXPECT_EQ(parse_plan(none, "/case")->teeth_source, TeethSource::kNone);
  EXPECT_EQ(parse_plan(plan_with(R"({"teeth": "none"})"), "/case")->teeth_source,
            TeethSource::kNone);
  EXPECT_EQ(parse_plan(automatic, "/case")->teeth_source, TeethSource::kAuto);
  EXPECT_FALSE(parse_plan(automatic, "/case")->teeth);
  const PlanFile with_file = parse_plan(file, "/case").value();
  EXPECT_EQ(with_file.teeth_source, TeethSource::kFile);
  EXPECT_EQ(with_file.teeth, "/case/head/teeth.seg.nrrd");
  EXPECT_TRUE(files_of_plan(automatic).empty());
  EXPECT_EQ(files_of_plan(file), std::vector<std::string>{"head/teeth.seg.nrrd"});

  EXPECT_EQ(parse_plan(with_teeth(file, "none"), "/case")->teeth_source, TeethSource::kNone);
  EXPECT_EQ(parse_plan(with_teeth(none, "auto"), "/case")->teeth_source, TeethSource::kAuto);
  EXPECT_EQ(parse_plan(with_teeth(none, "/other/t.seg.nrrd"), "/case")->teeth, "/other/t.seg.nrrd");
  EXPECT_EQ(parse_plan(with_teeth(none, "t.seg.nrrd"), "/case")->teeth,
            std::filesystem::current_path() / "t.seg.nrrd");
}

}  // namespace
}  // namespace lefort::io::test_plan_file
