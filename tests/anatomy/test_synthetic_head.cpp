// From scan to labels and surfaces, on a head whose true tissues are known.
#include <lefort/anatomy/extract_surface.h>
#include <lefort/anatomy/histogram_thresholds.h>
#include <lefort/anatomy/segment_tissue.h>
#include <lefort/anatomy/synthetic_head.h>
#include <lefort/anatomy/tissue_levels.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "support/dice.h"

namespace lefort::anatomy::test_synthetic_head {
namespace {

using test::is;

struct Head {
  image::CtVolume ct = synthetic_scan(synthetic_grid(1.4));
  LabelMap truth = synthetic_labels(ct.grid);
  HistogramThresholds thresholds = find_thresholds(ct).value();
  SegmentationOptions options = [this] {
    SegmentationOptions found;
    found.bone_hu = thresholds.bone_hu;
    found.skin_hu = thresholds.skin_hu;
    return found;
  }();
  LabelMap labels = segment_tissue(ct, options).value();
};

const Head& head() {
  static const Head instance;
  return instance;
}

bool is_soft(Tissue tissue) { return tissue == Tissue::kSoftTissue || tissue == Tissue::kBrain; }
bool is_inner_air(Tissue tissue) { return tissue == Tissue::kAirway || tissue == Tissue::kSinus; }

TEST(SyntheticHead, SegmentationMatchesItsTissues) {
  const std::pair<const char*, test::Belongs> tissues[] = {
      {"bone", is_bone},
      {"skull", is(Tissue::kBone)},
      {"mandible", is(Tissue::kMandible)},
      {"soft tissue and brain", is_soft},
      {"brain", is(Tissue::kBrain)},
      {"facial soft tissue", is(Tissue::kSoftTissue)},
      {"inner air", is_inner_air},
      {"airway", is(Tissue::kAirway)},
      {"sinuses", is(Tissue::kSinus)}};
  for (const auto& [name, belongs] : tissues) {
    const double found = test::dice(head().labels, head().truth, belongs);
    RecordProperty(name, std::to_string(found));
    EXPECT_GE(found, 0.97) << name;
  }
}

/// Distances of the vertices of a surface from the zero of a formula: 99th percentile and max [mm].
std::pair<double, double> deviation(const geometry::TriangleMesh& mesh,
                                    const std::function<double(const Vec3&)>& formula) {
  std::vector<double> off_mm;
  for (const Vec3& p : mesh.vertices) off_mm.push_back(std::abs(formula(p)));
  std::sort(off_mm.begin(), off_mm.end());
  return {off_mm[off_mm.size() * 99 / 100], off_mm.back()};
}

TEST(SyntheticHead, SurfacesLieWithinHalfAVoxelOfItsFormulas) {
  const image::Grid& grid = head().ct.grid;
  const LevelOptions levels{.bone_hu = head().options.bone_hu, .skin_hu = head().options.skin_hu};
  const double half_voxel_mm = 0.5 * grid.spacing_mm.x();
  const auto above_cut = [&](const Vec3& p) { return p.z() - (grid.origin_L.z() - half_voxel_mm); };
  const auto bones =
      extract_isosurface(bone_level(head().ct, head().labels, Cavities::kKeep, levels)).value();
  const auto [bone_p99, max_bone] = deviation(bones, [&](const Vec3& p) {
    using namespace synthetic;
    const double solid = std::max({skull(p), mandible(p), column(p)});
    return std::min({solid, -airway(p), -sinuses(p), above_cut(p)});
  });
  const auto skin = extract_isosurface(skin_level(head().ct, head().labels, levels)).value();
  // The skin follows the nostrils, the formula does not: a few vertices are far.
  const auto [skin_p99, max_skin] =
      deviation(skin, [&](const Vec3& p) { return std::min(synthetic::skin(p), above_cut(p)); });
  RecordProperty("bone_p99_mm", std::to_string(bone_p99));
  RecordProperty("bone_most_mm", std::to_string(max_bone));
  RecordProperty("skin_p99_mm", std::to_string(skin_p99));
  EXPECT_LT(bone_p99, half_voxel_mm);
  EXPECT_LT(max_bone, 2.0 * half_voxel_mm);
  EXPECT_LT(skin_p99, half_voxel_mm);
}

}  // namespace
}  // namespace lefort::anatomy::test_synthetic_head
