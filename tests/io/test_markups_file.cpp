#include <lefort/io/markups_file.h>
#include <lefort/io/write_atomically.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "support/run_python.h"
#include "support/temporary_folder.h"

namespace lefort::io::test_markups_file {
namespace {

using Json = nlohmann::json;

/// A point list of Slicer 5, shortened.
Json slicer_points(const char* system) {
  Json json = Json::parse(R"({
    "@schema": "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/Resources/Schema/markups-schema-v1.0.3.json#",
    "markups": [{
      "type": "Fiducial", "coordinateUnits": "mm", "locked": false,
      "fixedNumberOfControlPoints": false, "labelFormat": "%N-%d", "lastUsedControlPointNumber": 3,
      "controlPoints": [
        {"id": "1", "label": "A", "description": "", "associatedNodeID": "vtkMRMLScalarVolumeNode1",
         "position": [10.5, -20.25, 30.125], "orientation": [-1, 0, 0, 0, -1, 0, 0, 0, 1],
         "selected": true, "locked": false, "visibility": true, "positionStatus": "defined"},
        {"id": "2", "label": "B", "position": [0, 0, 0], "positionStatus": "undefined"},
        {"id": "3", "label": "Or-L", "position": [1, 2, 3], "positionStatus": "defined"}],
      "measurements": [], "display": {"visibility": true, "opacity": 1.0}
    }]})");
  json["markups"][0]["coordinateSystem"] = system;
  return json;
}

TEST(MarkupsFile, ReadsLpsAndConvertsRas) {
  const auto lps = parse_markups(slicer_points("LPS").dump());
  ASSERT_TRUE(lps) << lps.error().message;
  ASSERT_EQ(lps->size(), 1U);
  EXPECT_EQ((*lps)[0].type, "Fiducial");
  ASSERT_EQ((*lps)[0].points.size(), 2U);  // B is not placed.
  EXPECT_EQ((*lps)[0].points[0].name, "A");
  EXPECT_EQ((*lps)[0].points[0].point_L, Vec3(10.5, -20.25, 30.125));
  const auto ras = parse_markups(slicer_points("RAS").dump()).value();
  EXPECT_EQ(ras[0].points[0].point_L, Vec3(-10.5, 20.25, 30.125));
  EXPECT_EQ(ras[0].points[1].point_L, Vec3(-1, -2, 3));
  Json silent = slicer_points("LPS");
  silent["markups"][0].erase("coordinateSystem");
  EXPECT_EQ(parse_markups(silent.dump()).value()[0].points[0].point_L, Vec3(10.5, -20.25, 30.125));
}

TEST(MarkupsFile, ReadsOrRejectsUnits) {
  Json json = slicer_points("LPS");
  json["markups"][0]["coordinateUnits"] = {"um", "UCUM", "micrometer"};
  EXPECT_EQ(parse_markups(json.dump()).value()[0].points[1].point_L, Vec3(1, 2, 3) * 1e-3);
  json["markups"][0]["coordinateUnits"] = "in";
  const auto inches = parse_markups(json.dump());
  ASSERT_FALSE(inches);
  EXPECT_EQ(inches.error().code, ErrorCode::kFileUnsupported);
  EXPECT_NE(inches.error().message.find("markups[0].coordinateUnits"), std::string::npos);
}

TEST(MarkupsFile, RejectsInvalidMarkupsAndNamesTheKey) {
  const auto refuse = [](const std::string& text, const std::string& words) {
    const auto markups = parse_markups(text);
    ASSERT_FALSE(markups) << words;
    EXPECT_EQ(markups.error().code, ErrorCode::kFileCorrupt);
    EXPECT_NE(markups.error().message.find(words), std::string::npos) << markups.error().message;
    EXPECT_EQ(markups.error().message.find('\n'), std::string::npos);
  };
  refuse("", "not JSON");
  refuse("[]", "the markups file");
  refuse("{}", "markups");
  Json json = slicer_points("XYZ");
  refuse(json.dump(), "markups[0].coordinateSystem");
  json = slicer_points("LPS");
  json["markups"][0]["controlPoints"][2]["position"] = {1, 2};
  refuse(json.dump(), "markups[0].controlPoints[2].position");
  json["markups"][0]["controlPoints"][2]["position"] = {1, 2, "three"};
  refuse(json.dump(), "markups[0].controlPoints[2].position[2]");
  json = slicer_points("LPS");
  json["markups"][0].erase("type");
  refuse(json.dump(), "type");
}

TEST(MarkupsFile, PythonReadsTheWrittenFile) {
  const test::TemporaryFolder folder;
  const plan::Landmarks points{{"A", {0.1, -20.3, 1e-3}}, {"quote \" and é", {1, 2, 3}}};
  ASSERT_TRUE(write_point_list(folder / "p.mrk.json", "landmarks", points));
  const auto [ran, out] = test::run_python(
      "import json,sys\n"
      "m = json.load(open(sys.argv[1], encoding=\"utf-8\"))[\"markups\"]\n"
      "assert len(m) == 1 and m[0][\"type\"] == \"Fiducial\"\n"
      "assert m[0][\"coordinateSystem\"] == \"LPS\" and m[0][\"coordinateUnits\"] == \"mm\"\n"
      "c = m[0][\"controlPoints\"]\n"
      "assert [p[\"position\"] for p in c] == [[0.1, -20.3, 0.001], [1.0, 2.0, 3.0]], c\n"
      "assert c[0][\"label\"] == \"A\" and c[1][\"label\"] == \"quote \\\" and \\u00e9\", c\n"
      "assert len({p[\"id\"] for p in c}) == 2\n"
      "print(\"read\")",
      (folder / "p.mrk.json").string());
  EXPECT_TRUE(ran) << out;
  EXPECT_EQ(out, "read\n");
}

TEST(MarkupsFile, MessagesNameTheFile) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(read_markups(folder / "none.mrk.json").error().code, ErrorCode::kFileNotFound);
  ASSERT_TRUE(write_text(folder / "bad.mrk.json", "{"));
  EXPECT_NE(read_markups(folder / "bad.mrk.json").error().message.find("bad.mrk.json"),
            std::string::npos);
}

TEST(MarkupsFile, ReadsCenterNormalAndSizeOfAPlane) {
  const auto markups = parse_markups(R"({"markups": [{"type": "Plane", "coordinateSystem": "RAS",
    "center": [10, 20, 30], "normal": [0, 0, 5], "size": [8, 6, 0],
    "orientation": [0, -1, 0, 1, 0, 0, 0, 0, 1]}]})");
  ASSERT_TRUE(markups) << markups.error().message;
  const auto& plane = markups->front().plane;
  ASSERT_TRUE(plane);
  EXPECT_EQ(plane->center_L, Vec3(-10, -20, 30));
  EXPECT_EQ(plane->normal_L, Vec3(0, 0, 1));
  EXPECT_EQ(plane->across_L, Vec3(0, -1, 0)) << "the first column, in L";
  EXPECT_EQ(plane->width_mm, 8.0);
  EXPECT_EQ(plane->height_mm, 6.0);
}

TEST(MarkupsFile, ChoosesAnUnknownWidthDirectionInThePlane) {
  const auto markups = parse_markups(
      R"({"markups": [{"type": "Plane", "center": [0, 0, 0], "normal": [1, 2, 3]}]})");
  ASSERT_TRUE(markups) << markups.error().message;
  const auto& plane = markups->front().plane;
  ASSERT_TRUE(plane);
  EXPECT_NEAR(plane->across_L.dot(plane->normal_L), 0.0, 1e-15);
  EXPECT_NEAR(plane->across_L.norm(), 1.0, 1e-15);
  EXPECT_EQ(plane->width_mm, 0.0);
}

TEST(MarkupsFile, RejectsAPlaneWithoutANormal) {
  for (const char* normal : {"[0, 0, 0]", "[0, 0]", "\"up\"", "[1e300, 0, 0]"}) {
    const auto markups = parse_markups(
        std::string(R"({"markups": [{"type": "Plane", "center": [0, 0, 0], "normal": )") + normal +
        "}]}");
    ASSERT_FALSE(markups) << normal;
    EXPECT_EQ(markups.error().code, ErrorCode::kFileCorrupt);
    EXPECT_NE(markups.error().message.find("markups[0].normal"), std::string::npos)
        << markups.error().message;
  }
}

}  // namespace
}  // namespace lefort::io::test_markups_file
