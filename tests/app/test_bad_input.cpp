/// \file
/// Bad input of every kind, as a user meets it: one clear line on stderr, exit code 1, and no file
/// made, changed or left behind. Kinds that need a server or a full disk are in test_dicomweb.cpp,
/// test_command_line.cpp and test_volume_files.cpp.
#include <lefort/io/surface_files.h>
#include <lefort/io/volume_files.h>
#include <lefort/io/write_atomically.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <iostream>
#include <map>
#include <memory>
#include <sstream>
#include <string>

#include "support/run_program.h"
#include "support/shapes.h"
#include "support/small_head.h"
#include "support/temporary_folder.h"

namespace lefort::app::test_bad_input {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

struct BadInput {
  std::string name;
  std::string prepare;    ///< Shell commands in a fresh folder; $good holds the good files.
  std::string arguments;  ///< Of lefort, in that folder.
  std::string says;       ///< On stderr.
};

/// What lies under a folder: time of the last change of every entry, and the sizes of files. But for
/// the stages that a prediction finished before it failed, which it keeps for the next run.
std::map<std::string, std::string> contents(const fs::path& folder) {
  std::map<std::string, std::string> found;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const fs::path& path = entry.path();
    std::error_code ignored;
    if (path.string().find("/out/cache") != std::string::npos ||
        fs::exists(path / "cache", ignored))
      continue;
    const bool has_size = !entry.is_symlink() && entry.is_regular_file();
    const std::string size = has_size ? std::to_string(entry.file_size()) + " bytes" : "";
    const auto changed =
        entry.is_symlink() ? 0 : entry.last_write_time().time_since_epoch().count();
    found[path.string()] = size + " " + std::to_string(changed);
  }
  return found;
}

/// Warnings about a good scan may stand before the message.
int lines_but_warnings(const std::string& text) {
  std::istringstream lines(text);
  int count = 0;
  for (std::string line; std::getline(lines, line);) count += line.starts_with("warning: ") ? 0 : 1;
  return count;
}

std::string quoted(const fs::path& path) { return "'" + path.string() + "'"; }

/// Good files to spoil: dicom/ (a synthetic head), ct.nrrd, labels.seg.nrrd of another scan, ball.stl
/// and box.stl.
const fs::path& good() {
  static const auto folder = [] {
    auto made = std::make_unique<test::TemporaryFolder>();
    const fs::path at = made->path();
    for (const std::string more : {"", "/tilted --variant tilted"})
      EXPECT_EQ(
          test::run_lefort("--quiet phantom --voxel 5 -o '" + at.string() + "'" + more).exit_code,
          0);
    EXPECT_TRUE(io::write_volume(at / "ct.nrrd", test::small_head()));
    EXPECT_TRUE(io::write_surface(at / "ball.stl", test::make_icosphere(50.0, 3)));
    EXPECT_TRUE(io::write_surface(at / "far.stl", test::make_icosphere(5.0, 2, {900, 0, 0})));
    EXPECT_TRUE(io::write_surface(at / "box.stl", test::make_box({-10, -20, -10}, {10, 20, 10})));
    geometry::TriangleMesh open = test::make_box({-10, -20, -10}, {10, 20, 10});
    open.triangles.pop_back();
    EXPECT_TRUE(io::write_surface(at / "open.stl", open));
    json plan = test::small_plan();
    EXPECT_TRUE(io::write_text(at / "plan.json", plan.dump()));
    return made;
  }();
  return folder->path();
}

/// The plan of small_head.h, changed by a JSON patch, as commands that write plan.json.
std::string plan(const std::string& patch) {
  const json changed = test::small_plan().patch(json::parse(patch));
  return "cat > plan.json <<'END'\n" + changed.dump() + "\nEND\n";
}

std::string osteotomy(const std::string& value) {
  return plan(R"([{"op": "replace", "path": "/segments/0/osteotomy", "value": )" + value + "}]");
}

std::string keyframe(const std::string& value) {
  return plan(R"([{"op": "replace", "path": "/segments/0/path/keyframes/0", "value": )" + value +
              "}]");
}

std::string file(const std::string& name, const std::string& text) {
  return "cat > " + name + " <<'END'\n" + text + "\nEND\n";
}

/// A NRRD of `type` with these sizes; `voxels` in the file are text.
std::string nrrd(const std::string& type, const std::string& sizes, const std::string& voxels,
                 const std::string& directions = "(1,0,0) (0,1,0) (0,0,1)") {
  return file("a.nrrd", "NRRD0004\ntype: " + type +
                            "\ndimension: 3\nspace: left-posterior-superior\nsizes: " + sizes +
                            "\nspace directions: " + directions +
                            "\nkinds: domain domain domain\nendian: little\nencoding: ascii\n"
                            "space origin: (0,0,0)\n\n" +
                            voxels);
}

std::string markup(const std::string& changes, const std::string& type = "Fiducial") {
  json all = json::parse(R"({"markups": [{"type": ")" + type + R"(", "coordinateSystem": "LPS",
    "coordinateUnits": "mm", "controlPoints": [{"label": "A", "position": [0, -20, 0]},
    {"label": "B", "position": [1, -20, 0]}, {"label": "PNS", "position": [0, -20, 3]}]}]})");
  all["markups"][0].merge_patch(json::parse(changes));
  return file("p.mrk.json", all.dump());
}

const std::string kImport = "import dicom -o ct.nrrd";
const std::string kImportNrrd = "import a.nrrd -o ct.nrrd";
const std::string kCopyDicom = "cp -r $good/dicom .; ";
const std::string kCheck = "plan check plan.json --skull $good/box.stl -o out --no-pictures";
const std::string kPredict = "predict plan.json --ct $good/ct.nrrd -o out";

const BadInput kBadInput[] = {
    // Scans.
    {"missing", "", kImport, "does not exist"},
    {"empty folder", "mkdir dicom", kImport, "has no DICOM files"},
    {"folder of other files", "mkdir dicom; echo a > dicom/a.txt; echo b > dicom/b", kImport,
     "has no DICOM files"},
    {"a loop of links", "ln -s dicom dicom", kImport, "does not exist"},
    {"a folder within itself", "mkdir dicom; ln -s .. dicom/up", kImport, "has no DICOM files"},
    {"a slice cut short", kCopyDicom + "truncate -s 1500 dicom/slice-0020.dcm", kImport,
     "slice 20 (file 20): it is truncated or damaged"},
    {"every slice cut short", kCopyDicom + "truncate -s 300 dicom/*", kImport,
     "truncated or damaged"},
    {"every slice empty", kCopyDicom + "truncate -s 0 dicom/*", kImport,
     "truncated or not a DICOM file"},
    {"a slice missing", kCopyDicom + "rm dicom/slice-0020.dcm", kImport,
     "1 slices are missing between slice 19"},
    {"every second slice missing of one half",
     kCopyDicom + "rm dicom/slice-00[0-2]?.dcm; cp $good/dicom/slice-001[02468].dcm dicom", kImport,
     "slices are missing"},
    {"one slice alone", "mkdir dicom; cp $good/dicom/slice-0020.dcm dicom", kImport,
     "has no CT series, only: 1 = CT"},
    {"two series", kCopyDicom + "cp -r $good/tilted/dicom dicom/other", kImport,
     "several CT series, choose one by its number"},
    {"a series that is not there", kCopyDicom, kImport + " --series 7", "there is no series 7"},
    {"a single file of a series", kCopyDicom, "import dicom/slice-0020.dcm -o ct.nrrd",
     "expected a folder of DICOM files"},
    {"a pipe as a scan", "mkfifo a.nrrd", kImportNrrd, "not a regular file"},
    {"a device as a scan", "ln -s /dev/zero a.nrrd", kImportNrrd, "not a regular file"},
    {"no voxel that is a number", nrrd("float", "2 2 1", "nan nan nan nan"), kImportNrrd,
     "no voxel is a number"},
    {"too few voxels", nrrd("short", "2 2 2", "0 1 2"), kImportNrrd, "truncated or damaged"},
    {"huge sizes", nrrd("short", "2000000 2000000 2000000", "0"), kImportNrrd,
     "expected 1 to 2147483648 in all"},
    {"large sizes without voxels", nrrd("short", "4000 4000 4000", "0"), kImportNrrd,
     "expected 1 to 2147483648 in all"},
    {"no size", nrrd("short", "0 2 2", ""), kImportNrrd, "expected 1 to 2147483648 in all"},
    {"negative size", nrrd("short", "-2 2 2", "0 1 2 3"), kImportNrrd,
     "expected 1 to 2147483648 in all"},
    {"flat voxels", nrrd("short", "2 2 2", "0 1 2 3 4 5 6 7", "(1,0,0) (2,0,0) (0,0,1)"),
     kImportNrrd, "orthogonal unit vectors"},
    {"voxels without width", nrrd("short", "2 2 2", "0 1 2 3 4 5 6 7", "(0,0,0) (0,1,0) (0,0,1)"),
     kImportNrrd, "a spacing of 0 mm"},
    {"truncated volume", "head -c 2000 $good/ct.nrrd > a.nrrd", kImportNrrd,
     "truncated or damaged"},
    {"voxels elsewhere",
     file("a.mhd",
          "ObjectType = Image\nNDims = 3\nDimSize = 2 2 2\nElementType = MET_SHORT\n"
          "TransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = 0 0 0\nElementSpacing = 1 1 1\n"
          "ElementDataFile = /etc/passwd"),
     "import a.mhd -o ct.nrrd", "not in one file in the folder of the header"},
    {"an archive that is none", "echo no > a.inv3", "import a.inv3 -o ct.nrrd",
     "has no entry main.plist"},
    {"output of another kind", "", "import $good/ct.nrrd -o ct.txt", "ct.txt must end in"},
    {"output in no folder", "", "import $good/ct.nrrd -o none/ct.nrrd",
     "none/ct.nrrd cannot be written"},
    {"output in a file", "touch none", "import $good/ct.nrrd -o none/ct.nrrd", "Not a directory"},
    {"output is a folder", "mkdir ct.nrrd", "import $good/ct.nrrd -o ct.nrrd", "Is a directory"},
    {"output through a loop", "ln -s ct.nrrd ct.nrrd", "import $good/ct.nrrd -o ct.nrrd/a.nrrd",
     "cannot be written"},
    // Servers.
    {"nobody listens", "", "import dicomweb://127.0.0.1:1/studies/1.2.3 -o ct.nrrd",
     "no server answers at 127.0.0.1:1"},
    {"no such host", "", "import dicomweb://host.invalid:80/studies/1.2.3 -o ct.nrrd",
     "no server answers at host.invalid:80"},
    {"no study in the address", "", "import dicomweb://127.0.0.1:1/ -o ct.nrrd", "names no study"},
    {"no port of a server", "", "import dicomweb://127.0.0.1:99999/studies/1.2.3 -o ct.nrrd",
     "not a number from 1 to 65535"},
    // Tissues.
    {"air alone", nrrd("short", "2 2 2", "-1000 -1000 -1000 -1000 -1000 -1000 -1000 -1000"),
     "segment a.nrrd -o out", "-1000 HU everywhere"},
    {"no bone", "", "segment $good/ct.nrrd -o out --bone-hu 1900", "0.00 ml of bone"},
    {"skin denser than bone", "", "segment $good/ct.nrrd -o out --bone-hu -200 --skin-hu -100",
     "bone must be denser than skin"},
    {"tissues into a file", "touch out", "segment $good/ct.nrrd -o out", "Not a directory"},
    {"tissues of a truncated scan", "head -c 2000 $good/ct.nrrd > a.nrrd", "segment a.nrrd -o out",
     "truncated or damaged"},
    // Plans.
    {"no plan", "", kCheck, "plan.json is not a file"},
    {"an empty plan", "touch plan.json", kCheck, "the file is empty"},
    {"half a plan", "head -c 80 $good/plan.json > plan.json", kCheck,
     "not JSON: syntax error (byte 81)"},
    {"another version", plan(R"([{"op": "replace", "path": "/lefort_plan", "value": 2}])"), kCheck,
     "lefort_plan: the value is not one of those allowed"},
    {"a key nobody knows", plan(R"([{"op": "add", "path": "/hue", "value": "red"}])"), kCheck,
     "unknown key 'hue'"},
    {"a plane beside the bone",
     osteotomy(R"({"planes": [{"point_mm": [0, -50, 0], "towards_segment": [0, -1, 0]}]})"), kCheck,
     "no bone lies inside its planes"},
    {"a plane that leaves nothing",
     osteotomy(R"({"planes": [{"point_mm": [0, 50, 0], "towards_segment": [0, -1, 0]}]})"), kCheck,
     "all bone lies inside its planes"},
    {"a plane without direction",
     osteotomy(R"({"planes": [{"point_mm": [0, 0, 0], "towards_segment": [0, 0, 0]}]})"), kCheck,
     "the vector is zero"},
    {"a bounded plane that bone runs around",
     osteotomy(R"({"planes": [{"point_mm": [0, 0, 0], "towards_segment": [0, -1, 0],
       "size_mm": [6, 6], "across": [1, 0, 0]}]})"),
     kCheck, "does not separate the bone"},
    {"a curve that crosses itself",
     osteotomy(R"({"curves": [{"points_mm": [[-5, -30, -5], [5, -30, 5], [5, -30, -5],
       [-5, -30, 5]], "along": [0, 1, 0]}]})"),
     kCheck, "crosses or touches itself"},
    {"a template without landmarks", osteotomy(R"({"template": "le-fort-1"})"), kCheck,
     "landmark ANS (anterior nasal spine) is missing"},
    {"a landmark that is not there",
     osteotomy(R"({"planes": [{"point_mm": [0, -5, 0], "towards_segment": [0, -1, 0]}],
       "anchor_points": ["ANS"]})"),
     kCheck, "no landmark ANS"},
    {"cut out of an unknown segment",
     plan(R"([{"op": "add", "path": "/segments/0/cut_from", "value": "nobody"}])"), kCheck,
     "'nobody', which is not an earlier segment"},
    {"two segments of one name",
     plan(R"([{"op": "copy", "from": "/segments/0", "path": "/segments/-"}])"), kCheck,
     "two segments are called 'front'"},
    {"a motion with a number that is too large", "sed 's/-3/-3e999/' $good/plan.json > plan.json",
     kCheck, "a number is too large"},
    {"a transform that is missing", keyframe(R"({"transform": "move.tfm", "about_mm": [0, 0, 0]})"),
     kCheck, "move.tfm is not a file"},
    {"a transform that stretches",
     keyframe(R"({"transform": "move.tfm", "about_mm": [0, 0, 0]})") +
         file("move.tfm",
              "#Insight Transform File V1.0\n#Transform 0\nTransform: "
              "AffineTransform_double_3_3\nParameters: 2 0 0 0 1 0 0 0 1 0 0 0\n"
              "FixedParameters: 0 0 0"),
     kCheck, "scales or shears"},
    {"landmarks in other units", plan(R"([{"op": "add", "path": "/landmarks",
       "value": "p.mrk.json"}])") + markup(R"({"coordinateUnits": "inch"})"),
     kCheck, "coordinateUnits: must be mm or um"},
    {"landmarks in an unknown frame", plan(R"([{"op": "add", "path": "/landmarks",
       "value": "p.mrk.json"}])") + markup(R"({"coordinateSystem": "XYZ"})"),
     kCheck, "coordinateSystem: the value is not one of those allowed"},
    {"landmarks far from the bone",
     plan(R"([{"op": "add", "path": "/landmarks",
       "value": "p.mrk.json"}, {"op": "add", "path": "/segments/0/osteotomy/anchor_points",
       "value": ["A"]}])") +
         markup(R"({"controlPoints": [{"label": "A", "position": [0, -900, 0]}]})"),
     kCheck, "lies within 5 mm of the anchor point (0.0, -900.0, 0.0)"},
    {"a skull with a hole", "cp $good/plan.json .",
     "plan check plan.json --skull $good/open.stl -o out --no-pictures", "the surface is open"},
    {"a skull that is none", "cp $good/plan.json .; echo solid > skull.stl",
     "plan check plan.json --skull skull.stl -o out --no-pictures", "skull.stl is truncated"},
    {"results into a file", "cp $good/plan.json .; touch out", kCheck, "Not a directory"},
    {"results over someone's files", "cp $good/plan.json .; mkdir out; echo mine > out/check.json",
     kCheck, "is not a file of an earlier check"},
    // Predictions.
    {"labels of another scan",
     plan(R"([{"op": "add", "path": "/segmentation", "value": {"labels": "a.seg.nrrd"}}])") +
         "cp $good/labels.seg.nrrd a.seg.nrrd",
     kPredict, "do not coincide with those of the scan"},
    {"labels without tissues",
     plan(R"([{"op": "add", "path": "/segmentation", "value": {"labels": "a.seg.nrrd"}}])") +
         "cp $good/ct.nrrd a.seg.nrrd",
     kPredict, "no segment has the name of a tissue"},
    {"labels that are missing",
     plan(R"([{"op": "add", "path": "/segmentation", "value": {"labels": "a.seg.nrrd"}}])"),
     kPredict, "a.seg.nrrd is not a file"},
    {"muscle without labels", plan(R"([{"op": "add", "path": "/tissue/muscle", "value":
       {"material": {"law": "neo-hookean", "young_kpa": 60, "poisson": 0.45}}}])"),
     kPredict, "tissue.muscle: no voxel of the labels is muscle"},
    {"boundary labels of another scan",
     plan(R"([{"op": "add", "path": "/boundary", "value": {"labels": "a.seg.nrrd"}}])") +
         "sed 's/Name:=bone/Name:=fixed/; /^Segment[1-9]_/d' $good/labels.seg.nrrd > a.seg.nrrd",
     kPredict, "boundary.labels: the voxels do not coincide with those of the scan"},
    {"boundary labels of tissues",
     plan(R"([{"op": "add", "path": "/boundary", "value": {"labels": "a.seg.nrrd"}}])") +
         "cp $good/labels.seg.nrrd a.seg.nrrd",
     kPredict,
     "segment 0 is named \"bone\", expected fixed, free, with segment, contact, bonded, elevated "
     "or sliding"},
    {"boundary labels that are missing",
     plan(R"([{"op": "add", "path": "/boundary", "value": {"labels": "a.seg.nrrd"}}])"), kPredict,
     "a.seg.nrrd is not a file"},
    {"a scan that is missing", "cp $good/plan.json .", "predict plan.json -o out",
     "does not exist"},
    {"a plane beside the head",
     osteotomy(R"({"planes": [{"point_mm": [0, -90, 0], "towards_segment": [0, -1, 0]}]})"),
     kPredict, "no bone lies inside its planes"},
    {"a prediction into a file", "cp $good/plan.json .; touch out", kPredict, "Not a directory"},
    // Faces.
    {"a face that is none", "echo solid > a.stl", "compare a.stl $good/ball.stl -o out",
     "a.stl is truncated"},
    {"a face of another frame", "", "compare $good/far.stl $good/ball.stl -o out", "same frame"},
    {"a face that is missing", "", "compare a.stl $good/ball.stl -o out", "a.stl is not a file"},
    {"face landmarks in other units", markup(R"({"coordinateUnits": "inch"})"),
     "compare $good/ball.stl $good/ball.stl --landmarks p.mrk.json -o out", "must be mm or um"},
    {"a folder without a prediction", "mkdir a", "compare a $good/ball.stl -o out",
     "no prediction.json"},
    // Landmarks.
    {"a curve for landmarks", markup("{}", "ClosedCurve"), "landmarks p.mrk.json",
     "it has no landmark"},
    {"a table that is none", "head -c 500 /dev/zero > a.csv", "landmarks a.csv",
     "must name the columns"},
    // Phantom.
    {"a phantom over files", "mkdir dicom; touch dicom/mine", "phantom -o . --voxel 5",
     "expected an empty folder"},
    {"a phantom into a file", "touch head", "phantom -o head --voxel 5", "Not a directory"},
};

class BadInputTest : public testing::TestWithParam<BadInput> {};

TEST_P(BadInputTest, IsOneClearLineAndLeavesEverythingAsItWas) {
  const BadInput& bad = GetParam();
  const test::TemporaryFolder folder;
  const std::string enter =
      "export good=" + quoted(good()) + "; cd " + quoted(folder.path()) + "; ";
  ASSERT_TRUE(io::write_text(folder / "prepare.sh", enter + bad.prepare));
  ASSERT_EQ(std::system(("bash " + quoted(folder / "prepare.sh")).c_str()), 0);
  const auto before = contents(folder.path());
  // Escaped for run_lefort's own shell.
  std::string arguments = bad.arguments;
  for (std::size_t at; (at = arguments.find("$good")) != std::string::npos;)
    arguments.replace(at, 5, good().string());
  const auto run =
      test::run_lefort("--quiet --threads 1 " + arguments, "cd " + quoted(folder.path()) + ";");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_EQ(lines_but_warnings(run.error), 1) << run.error;
  EXPECT_EQ(run.message_lines(), 1) << run.error;
  EXPECT_NE(run.error.find(bad.says), std::string::npos) << run.error;
  EXPECT_EQ(run.out, "");
  EXPECT_EQ(contents(folder.path()), before);
  std::cout << run.error;
}

INSTANTIATE_TEST_SUITE_P(Kinds, BadInputTest, testing::ValuesIn(kBadInput),
                         [](const testing::TestParamInfo<BadInput>& kind) {
                           std::string name = kind.param.name;
                           std::replace_if(
                               name.begin(), name.end(),
                               [](char c) { return std::isalnum(c) == 0; }, '_');
                           return name;
                         });

}  // namespace
}  // namespace lefort::app::test_bad_input
