// A publicly available CT from the Debian package invesalius-examples: a head with a defect of the
// frontal bone on the patient's right, in a head holder. The tests are skipped if it is not
// installed.
#include <lefort/anatomy/extract_surface.h>
#include <lefort/anatomy/segment_tissue.h>
#include <lefort/anatomy/tissue_levels.h>

#include <gtest/gtest.h>
#include <stdio.h>

#include <array>
#include <optional>

#include "anatomy/mesh_checks.h"
#include "support/real_scan.h"

namespace lefort::anatomy::test_real_scan {
namespace {

/// 108 x 256 x 256 voxels in LPS; the rows of the file run to anterior.
std::optional<image::CtVolume> read_scan() {
  const std::string command =
      "tar -xzOf '" + test::real_scan().string() + "' --wildcards '*/matrix.dat' 2>/dev/null";
  FILE* pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr) return {};
  image::CtVolume ct{{{256, 256, 108}, {0.957031, 0.957031, 1.5}, {0, 0, 0}, Mat3::Identity()}, {}};
  ct.values.resize(std::size_t(ct.grid.voxel_count()));
  bool whole = true;
  for (Index k = 0; k < 108; ++k)
    for (Index j = 255; j >= 0; --j) whole &= ::fread(&ct.at(0, j, k), 2, 256, pipe) == 256;
  ::pclose(pipe);
  if (!whole) return {};
  return ct;
}

struct Case {
  image::CtVolume ct;
  LabelMap labels;
  [[nodiscard]] double ml_of(Tissue tissue) const {
    return double(std::count(labels.values.begin(), labels.values.end(), tissue)) *
           ct.grid.spacing_mm.prod() * 1e-3;
  }
};

const std::optional<Case>& real_case() {
  static const std::optional<Case> value = []() -> std::optional<Case> {
    auto ct = read_scan();
    if (!ct) return {};
    auto labels = segment_tissue(*ct).value();
    return Case{std::move(*ct), std::move(labels)};
  }();
  return value;
}

#define NEED_SCAN() \
  ASSERT_TRUE(real_case()) << "Debian's invesalius-examples is neither installed nor available"

/// There is no independent truth: the thresholds were chosen on this scan, and the expected values
/// are the results. Only the brain can be compared, with about 1500 ml of an adult man's cranial
/// cavity.
TEST(RealScan, VolumesAreThoseOfTheTimeWhenTheThresholdsWereChosen) {
  NEED_SCAN();
  const Case& head = *real_case();
  EXPECT_NEAR(head.ml_of(Tissue::kBrain), 1500.0, 100.0);
  EXPECT_NEAR(head.ml_of(Tissue::kBone), 600.0, 60.0);
  EXPECT_NEAR(head.ml_of(Tissue::kSoftTissue), 1040.0, 100.0);
  EXPECT_NEAR(head.ml_of(Tissue::kSinus), 41.0, 12.0);
  EXPECT_NEAR(head.ml_of(Tissue::kAirway), 31.0, 12.0);
}

TEST(RealScan, TheHeadHolderIsRemoved) {
  NEED_SCAN();
  const Case& head = *real_case();
  // It is in all slices, at least 10 mm behind and beside the head: there are dense voxels that far
  // from labeled ones, and the outermost columns have no labels.
  Index dense_background = 0;
  for (Index k = 0; k < 108; ++k)
    for (Index j = 0; j < 256; ++j)
      for (Index i = 0; i < 256; ++i) {
        const bool background = head.labels.at(i, j, k) == Tissue::kBackground;
        if (background && head.ct.at(i, j, k) > 100) ++dense_background;
        const bool beside = i < 20 || i > 235 || j > 250;
        if (beside) {
          ASSERT_TRUE(background) << i << ' ' << j << ' ' << k;
        }
      }
  EXPECT_GT(dense_background, 20'000);
}

TEST(RealScan, TheFrontalDefectIsOnThePatientsRight) {
  NEED_SCAN();
  // Rays from inside the forehead to the front, right and left of the midline: which hit bone?
  const LabelMap& labels = real_case()->labels;
  const auto fraction_without_bone = [&](Index from, Index to) {
    int open = 0;
    int rays = 0;
    for (Index k = 55; k < 75; ++k)
      for (Index i = from; i < to; ++i, ++rays) {
        bool bone = false;
        for (Index j = 0; j < 110; ++j) bone |= labels.at(i, j, k) == Tissue::kBone;
        open += bone ? 0 : 1;
      }
    return double(open) / rays;
  };
  EXPECT_GT(fraction_without_bone(80, 100), 0.3);  // x to the left: low i is the right side.
  EXPECT_EQ(fraction_without_bone(156, 176), 0.0);
}

TEST(RealScan, SurfacesAreClosedAndTheSkinIsOne) {
  NEED_SCAN();
  const Case& head = *real_case();
  const auto skin = extract_isosurface(skin_level(head.ct, head.labels));
  ASSERT_TRUE(skin);
  EXPECT_EQ(test::count_bad_edges(*skin), 0);
  const auto without_fragments =
      extract_isosurface(skin_level(head.ct, head.labels), {.min_part_ml = 100.0});
  EXPECT_EQ(skin->triangle_count(), without_fragments->triangle_count());
  EXPECT_NEAR(test::volume(*skin) * 1e-3, 3200.0, 100.0);

  const auto bone = extract_isosurface(bone_level(head.ct, head.labels, Cavities::kFillSinuses),
                                       {.min_part_ml = 0.1});
  ASSERT_TRUE(bone);
  EXPECT_EQ(test::count_bad_edges(*bone), 0);
  const auto soft =
      extract_isosurface(soft_tissue_level(head.ct, head.labels), {.min_part_ml = 0.1});
  ASSERT_TRUE(soft);
  EXPECT_EQ(test::count_bad_edges(*soft), 0);
  EXPECT_NEAR(test::volume(*soft) * 1e-3, 1000.0, 100.0);
}

}  // namespace
}  // namespace lefort::anatomy::test_real_scan
