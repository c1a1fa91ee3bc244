// One synthetic head, scanned in several ways, from DICOM files to surfaces: the surfaces must be
// the same in the patient, whatever the scanner did, and the labels those that the formulas know.
#include <lefort/anatomy/synthetic_head.h>
#include <lefort/geometry/bvh.h>
#include <lefort/io/segmentation_file.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/volume_files.h>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>

#include "support/dice.h"
#include "support/run_program.h"
#include "support/temporary_folder.h"

namespace lefort::app::test_phantom_command {
namespace {

namespace synthetic = anatomy::synthetic;
using anatomy::LabelMap;
using anatomy::Tissue;
using geometry::TriangleMesh;
using test::run_lefort;

constexpr double kVoxel_mm = 1.4;
/// Nearer to the lowest slice the neck is cut off, by each variant's own slices.
constexpr double kAboveNeck_mm = -80.0;

struct Scanned {
  nlohmann::json import_json, segment_json;
  TriangleMesh skull, skin;
  LabelMap labels;
};

/// phantom, import and segment, as a user types them.
Scanned scanned(const std::filesystem::path& folder, const std::string& variant) {
  const std::string at = "'" + (folder / variant).string() + "'";
  const auto run = [](const std::string& arguments) {
    const auto result = run_lefort(arguments + " --json --quiet");
    EXPECT_EQ(result.exit_code, 0) << result.error;
    return result.exit_code == 0 ? nlohmann::json::parse(result.out) : nlohmann::json();
  };
  run("phantom -o " + at + " --variant " + variant);
  Scanned head;
  head.import_json = run("import " + at + "/dicom -o " + at + "/ct.nrrd");
  head.segment_json = run("segment " + at + "/ct.nrrd -o " + at + "/anatomy --auto-thresholds");
  head.skull = io::read_surface(folder / variant / "anatomy/skull.vtp").value();
  head.skin = io::read_surface(folder / variant / "anatomy/skin.vtp").value();
  const auto ct = io::read_volume(folder / variant / "ct.nrrd");
  head.labels =
      io::read_segmentation(folder / variant / "anatomy/labels.seg.nrrd", ct->ct.grid).value();
  return head;
}

const Scanned& head(const std::string& variant) {
  static const test::TemporaryFolder folder;
  static std::map<std::string, Scanned> all;
  const auto found = all.find(variant);
  return found != all.end() ? found->second
                            : all.emplace(variant, scanned(folder.path(), variant)).first->second;
}

struct Deviation {
  double mean, p99, maximum;
};

/// Of sorted distances.
Deviation deviation_of(std::vector<double> distances) {
  std::sort(distances.begin(), distances.end());
  double sum = 0.0;
  for (const double d : distances) sum += d;
  const auto count = distances.size();
  return {sum / double(count), distances[count * 99 / 100], distances.back()};
}

/// From the vertices of `a` above the neck to `b`.
Deviation between(const TriangleMesh& a, const geometry::Bvh& b) {
  std::vector<double> distances;
  for (const Vec3& p : a.vertices)
    if (p.z() > kAboveNeck_mm) distances.push_back(b.closest_point(p)->distance_mm);
  return deviation_of(std::move(distances));
}

class Phantom : public ::testing::TestWithParam<const char*> {};

TEST_P(Phantom, GivesTheSameSurfacesHoweverItIsScanned) {
  const Scanned& plain = head("plain");
  const Scanned& other = head(GetParam());
  for (const auto& [name, a, b] : {std::tuple("skull", &plain.skull, &other.skull),
                                   std::tuple("skin", &plain.skin, &other.skin)}) {
    const geometry::Bvh tree_a(*a), tree_b(*b);
    const Deviation there = between(*a, tree_b), back = between(*b, tree_a);
    RecordProperty(std::string(name) + "_mean_mm", std::to_string(std::max(there.mean, back.mean)));
    RecordProperty(std::string(name) + "_p99_mm", std::to_string(std::max(there.p99, back.p99)));
    RecordProperty(std::string(name) + "_most_mm",
                   std::to_string(std::max(there.maximum, back.maximum)));
    EXPECT_LT(std::max(there.mean, back.mean), 0.1) << name;
    EXPECT_LT(std::max(there.p99, back.p99), 0.2) << name;
  }
}

TEST_P(Phantom, EveryTissueIsFoundWhereItTrulyIs) {
  const Scanned& scan = head(GetParam());
  const LabelMap truth = anatomy::synthetic_labels(scan.labels.grid);
  std::string table;
  for (const auto& [name, tissue] :
       {std::pair("outside air", Tissue::kBackground), std::pair("bone", Tissue::kBone),
        std::pair("mandible", Tissue::kMandible), std::pair("soft tissue", Tissue::kSoftTissue),
        std::pair("brain", Tissue::kBrain), std::pair("airway", Tissue::kAirway),
        std::pair("sinus", Tissue::kSinus)}) {
    const double found = test::dice(scan.labels, truth, test::is(tissue));
    table += fmt::format("  {} {:.4f}", name, found);
    EXPECT_GE(found, 0.97) << name;
  }
  std::cout << GetParam() << ", Dice:" << table << '\n';
}

INSTANTIATE_TEST_SUITE_P(Variants, Phantom,
                         ::testing::Values("plain", "shuffled", "feet-first", "tilted", "oblique"));

TEST(PhantomCommand, ImportReportsTheOrientationOfTheSlices) {
  const auto tilted = head("tilted").import_json["geometry"]["slices"];
  EXPECT_NEAR(tilted["tilt_deg"].get<double>(), 15.0, 1e-3);
  EXPECT_TRUE(tilted["resampled"]);
  EXPECT_NEAR(tilted["min_step_mm"].get<double>(), kVoxel_mm * std::cos(M_PI / 12.0), 1e-4);
  const auto feet_first = head("feet-first").import_json["geometry"];
  EXPECT_FALSE(feet_first["slices"]["resampled"]);
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(feet_first["axes_lps"][2][k].get<double>(), k == 2 ? -1.0 : 0.0, 1e-12);
  EXPECT_EQ(head("plain").import_json["warnings"], head("shuffled").import_json["warnings"]);
}

TEST(PhantomCommand, ShuffledFilesGiveTheSameBits) {
  EXPECT_EQ(head("plain").skull.vertices, head("shuffled").skull.vertices);
  EXPECT_EQ(head("plain").skin.vertices, head("shuffled").skin.vertices);
}

/// Fails when left and right, front and back, or head and feet are exchanged anywhere on the way.
TEST(PhantomCommand, TheHeadIsNotMirrored) {
  for (const char* const variant : {"plain", "tilted", "oblique", "feet-first"}) {
    const LabelMap& labels = head(variant).labels;
    const auto at = [&](const Vec3& p_L) {
      const Vec3 v = labels.grid.index_V(p_L).array().round();
      return labels.at(Index(v[0]), Index(v[1]), Index(v[2]));
    };
    // The large sinus reaches where on the other side there is bone: its lateral wall.
    EXPECT_EQ(at({29.0, -50.0, -38.0}), Tissue::kSinus) << variant;
    EXPECT_EQ(at({-31.0, -50.0, -38.0}), Tissue::kBone) << variant;
    // The hole in the frontal bone is on the right.
    const Vec3 hole = Vec3(0.0, 5.0, 25.0) + 75.0 * Vec3(-0.5, -0.8, 0.35).normalized();
    EXPECT_NE(at(hole), Tissue::kBone) << variant;
    EXPECT_EQ(at({-hole.x(), hole.y(), hole.z()}), Tissue::kBone) << variant;
    // Face in front, vault above.
    EXPECT_EQ(at({0.0, -105.0, -34.0}), Tissue::kSoftTissue) << variant;
    EXPECT_EQ(at({0.0, 5.0, 99.0}), Tissue::kBone) << variant;
  }
}

}  // namespace
}  // namespace lefort::app::test_phantom_command
