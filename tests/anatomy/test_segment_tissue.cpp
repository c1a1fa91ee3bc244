#include <lefort/anatomy/segment_tissue.h>
#include <lefort/core/parallel.h>

#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <limits>
#include <map>
#include <string>

#include "anatomy/head_phantom.h"

namespace lefort::anatomy::test_segment_tissue {
namespace {

using test::HeadPhantom;

const HeadPhantom kHead;

constexpr double kDocumentedBytes = 40.0;  ///< Per voxel, as documented in segment_tissue.h.

const image::CtVolume& scan() {
  static const image::CtVolume ct = kHead.scan();
  return ct;
}

const LabelMap& labels() {
  static const LabelMap map = segment_tissue(scan()).value();
  return map;
}

template <class Visit>
void for_each_voxel(const image::Grid& grid, const Visit& visit) {
  for (Index k = 0; k < grid.size[2]; ++k)
    for (Index j = 0; j < grid.size[1]; ++j)
      for (Index i = 0; i < grid.size[0]; ++i)
        visit(grid.point_L({double(i), double(j), double(k)}), std::size_t(grid.offset(i, j, k)));
}

Tissue label_at(const LabelMap& map, const Vec3& p_L) {
  const Vec3 index = map.grid.index_V(p_L).array().round();
  return map.at(Index(index[0]), Index(index[1]), Index(index[2]));
}

double ml_of(const LabelMap& map, Tissue tissue) {
  return double(std::count(map.values.begin(), map.values.end(), tissue)) *
         map.grid.spacing_mm.prod() * 1e-3;
}

double ball_ml(double radius_mm) { return 4.0 / 3.0 * M_PI * std::pow(radius_mm, 3) * 1e-3; }

/// Numbers of voxels away from all borders whose tissue differs from that of the phantom.
std::map<std::pair<Tissue, Tissue>, int> disagreements(const HeadPhantom& head,
                                                       const LabelMap& map) {
  std::map<std::pair<Tissue, Tissue>, int> counts;
  for_each_voxel(map.grid, [&](const Vec3& p, std::size_t v) {
    const auto truth = head.tissue(p, 2.5);
    if (truth && *truth != map.values[v]) ++counts[{*truth, map.values[v]}];
  });
  return counts;
}

TEST(SegmentTissue, EveryVoxelAwayFromBordersHasThePhantomsTissue) {
  for (const auto& [tissues, count] : disagreements(kHead, labels()))
    ADD_FAILURE() << count << " voxels of tissue " << int(tissues.first) << " are labeled "
                  << int(tissues.second);
}

TEST(SegmentTissue, VoxelsOfOtherSizeAndShapeGiveThePhantomsTissue) {
  for (const Vec3& spacing_mm : {Vec3(1.2, 1.2, 3.0), Vec3(2.4, 1.2, 1.1), Vec3(1.2, 1.2, 1.1)}) {
    HeadPhantom head;
    head.spacing_mm = spacing_mm;
    const LabelMap map = segment_tissue(head.scan()).value();
    for (const auto& [tissues, count] : disagreements(head, map))
      EXPECT_LT(double(count), 1e-4 * double(map.values.size()))
          << spacing_mm.transpose() << ": " << int(tissues.first) << " as " << int(tissues.second);
    EXPECT_NEAR(ml_of(map, Tissue::kSinus), ball_ml(HeadPhantom::kSinusRadius), 0.6);
  }
}

TEST(SegmentTissue, VolumesAreThoseOfThePhantom) {
  EXPECT_NEAR(ml_of(labels(), Tissue::kSinus), ball_ml(HeadPhantom::kSinusRadius), 0.6);
  // Bone of 226 HU extends slightly beyond the middle of the phantom's gradients.
  const double beyond_mm = HeadPhantom::kBlur_mm * (1.0 - 2.0 * (226.0 - 40.0) / (900.0 - 40.0));
  const double brain = ball_ml(HeadPhantom::kInnerTable - beyond_mm);
  EXPECT_NEAR(ml_of(labels(), Tissue::kBrain), brain, 0.01 * brain);
  Index bone_voxels = 0;
  for_each_voxel(scan().grid, [&](const Vec3& p, std::size_t) {
    bone_voxels += kHead.bone(p) > -beyond_mm && kHead.sinus_air(p) < 0.0 ? 1 : 0;
  });
  const double bone = double(bone_voxels) * scan().grid.spacing_mm.prod() * 1e-3;
  EXPECT_NEAR(ml_of(labels(), Tissue::kBone), bone, 0.02 * bone);
}

TEST(SegmentTissue, TheHeadHolderIsRemoved) {
  int holder_voxels = 0;
  for_each_voxel(scan().grid, [&](const Vec3& p, std::size_t v) {
    if (kHead.holder(p) < 0.0) return;
    ++holder_voxels;
    EXPECT_EQ(labels().values[v], Tissue::kBackground);
  });
  EXPECT_GT(holder_voxels, 1000);
}

TEST(SegmentTissue, ATableThatTouchesTheHeadOverALargeAreaIsRemoved) {
  HeadPhantom head;
  head.has_table = true;
  const LabelMap map = segment_tissue(head.scan()).value();
  int table_voxels = 0;
  for_each_voxel(map.grid, [&](const Vec3& p, std::size_t v) {
    if (head.table(p) < 0.0) return;
    ++table_voxels;
    EXPECT_EQ(map.values[v], Tissue::kBackground);
  });
  EXPECT_GT(table_voxels, 10'000);
  for (const auto& [tissues, count] : disagreements(head, map))
    EXPECT_LT(count, 20) << int(tissues.first) << " as " << int(tissues.second);
}

TEST(SegmentTissue, BrainEndsBetweenTheTablesOfTheHoleOnThePatientsRight) {
  ASSERT_LT(kHead.defect_axis.x(), 0.0);
  double end_mm = 0.0;
  for (double r = 0.0; r < 84.0; r += 0.5)
    if (label_at(labels(), r * kHead.defect_axis) == Tissue::kBrain) end_mm = r;
  EXPECT_GT(end_mm, HeadPhantom::kInnerTable - 2.0);
  EXPECT_LT(end_mm, HeadPhantom::kOuterTable + 1.0);
  // There is no hole on the left.
  const Vec3 mirrored(-kHead.defect_axis.x(), kHead.defect_axis.y(), kHead.defect_axis.z());
  EXPECT_EQ(label_at(labels(), 71.0 * mirrored), Tissue::kBone);
  EXPECT_NE(label_at(labels(), 71.0 * kHead.defect_axis), Tissue::kBone);
}

TEST(SegmentTissue, AnIslandIsSoftTissueAndASecondBoneIsKept) {
  EXPECT_EQ(label_at(labels(), kHead.island), Tissue::kSoftTissue);
  EXPECT_EQ(label_at(labels(), kHead.jaw), Tissue::kBone);
}

TEST(SegmentTissue, AGridWithOtherAxesGivesTheSameTissueInThePatient) {
  Mat3 half_turn = Mat3::Identity();
  half_turn(0, 0) = half_turn(1, 1) = -1.0;
  Mat3 sagittal;  // i to posterior, j to superior, k to the left.
  sagittal << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  for (const Mat3& direction : {half_turn, sagittal}) {
    const LabelMap turned = segment_tissue(kHead.scan(direction)).value();
    Index differences = 0;
    for_each_voxel(turned.grid, [&](const Vec3& p, std::size_t v) {
      differences += turned.values[v] != label_at(labels(), p) ? 1 : 0;
    });
    // Ties between basins may be resolved differently.
    EXPECT_LT(double(differences), 1e-4 * double(turned.values.size()));
  }
}

TEST(SegmentTissue, SameBitsForAnyNumberOfThreads) {
  const std::vector<Tissue>& by_many = labels().values;  // Computed before the limit applies.
  const ThreadLimit limit(1);
  EXPECT_EQ(segment_tissue(scan()).value().values, by_many);
}

TEST(SegmentTissue, AScanOfTheLowerFaceHasNoBrain) {
  image::CtVolume face = scan();
  face.grid.size[2] = 12;
  face.values.resize(std::size_t(face.grid.voxel_count()));
  const LabelMap map = segment_tissue(face).value();
  EXPECT_EQ(ml_of(map, Tissue::kBrain), 0.0);
  EXPECT_GT(ml_of(map, Tissue::kBone), 5.0);
}

Error error_of(const image::CtVolume& ct, const SegmentationOptions& options = {}) {
  const auto result = segment_tissue(ct, options);
  EXPECT_FALSE(result);
  return result ? Error{ErrorCode::kNotConverged, ""} : result.error();
}

image::CtVolume block(std::int16_t hu) {
  image::CtVolume ct{{{20, 20, 20}, {2, 2, 2}, {0, 0, 0}, Mat3::Identity()}, {}};
  ct.values.assign(8000, hu);
  return ct;
}

TEST(SegmentTissue, NamesWhatAScanWithoutAHeadLacks) {
  EXPECT_EQ(error_of({}).code, ErrorCode::kAnatomyMissing);
  EXPECT_EQ(error_of(block(-1000)).message, "scan is -1000 HU everywhere, a head was expected");

  image::CtVolume air = block(-1000);
  air.at(10, 10, 10) = -900;
  EXPECT_EQ(error_of(air).message,
            "scan shows 0.00 ml of tissue (at least -300 HU), expected at least 1 ml");

  image::CtVolume water = block(-1000);
  for (Index k = 5; k < 15; ++k)
    for (Index j = 5; j < 15; ++j)
      for (Index i = 5; i < 15; ++i) water.at(i, j, k) = 0;
  EXPECT_EQ(error_of(water).message,
            "scan shows 0.00 ml of bone (at least 226 HU), expected at least 1 ml");

  image::CtVolume cropped = block(40);
  for (Index i = 0; i < 2000; ++i) cropped.values[std::size_t(i)] = 900;
  const Error no_air = error_of(cropped);
  EXPECT_EQ(no_air.code, ErrorCode::kAnatomyMissing);
  EXPECT_EQ(no_air.message,
            "scan shows 0.00 ml of air around the patient (below -300 HU, the threshold of skin), "
            "expected at least 1 ml");
}

TEST(SegmentTissue, RejectsOptionsOutOfRangeAndGridsThatDoNotMatchTheirValues) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const SegmentationOptions& options :
       {SegmentationOptions{.bone_hu = -400.0}, SegmentationOptions{.bone_hu = nan},
        SegmentationOptions{.skin_hu = 300.0}, SegmentationOptions{.min_bone_ml = -1.0},
        SegmentationOptions{.nostril_radius_mm = 0.0},
        SegmentationOptions{.nostril_radius_mm = 1e9}, SegmentationOptions{.ostium_radius_mm = nan},
        SegmentationOptions{.min_air_ml = -0.1}, SegmentationOptions{.max_memory_gib = 0.0},
        SegmentationOptions{.max_memory_gib = nan}})
    EXPECT_EQ(error_of(scan(), options).code, ErrorCode::kInvalidArgument);
  image::CtVolume ct = block(0);
  ct.values.pop_back();
  EXPECT_EQ(error_of(ct).code, ErrorCode::kInvalidArgument);
  ct = block(0);
  ct.grid.spacing_mm[1] = 0.0;
  EXPECT_EQ(error_of(ct).code, ErrorCode::kInvalidArgument);
  ct = block(0);
  ct.grid.size[0] = -20;
  EXPECT_EQ(error_of(ct).code, ErrorCode::kInvalidArgument);
}

TEST(SegmentTissue, RejectsAScanThatNeedsMoreMemoryThanIsAllowed) {
  const double needed_gib = kDocumentedBytes * double(scan().grid.voxel_count()) / double(1 << 30);
  ASSERT_TRUE(segment_tissue(scan(), {.max_memory_gib = 1.01 * needed_gib}));
  const Error error = error_of(scan(), {.max_memory_gib = 0.99 * needed_gib});
  EXPECT_EQ(error.code, ErrorCode::kInvalidArgument);
  EXPECT_NE(error.message.find("GiB of memory"), std::string::npos) << error.message;
}

/// A line of /proc/self/status [bytes]; 0 if it does not exist.
double status_bytes(const std::string& name) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with(name + ":")) return 1024.0 * std::stod(line.substr(name.size() + 1));
  return 0.0;
}

TEST(SegmentTissue, UsesNoMoreMemoryThanDocumented) {
  HeadPhantom head;
  head.spacing_mm = {1.0, 1.0, 1.1};
  const image::CtVolume ct = head.scan();
  if (!(std::ofstream("/proc/self/clear_refs") << "5" << std::flush) || status_bytes("VmHWM") == 0)
    GTEST_SKIP() << "the system does not report peak memory";
  const double before = status_bytes("VmHWM");  // Reset by the 5 above.
  if (status_bytes("VmPeak") > 1e12) GTEST_SKIP() << "a sanitizer uses additional memory";
  ASSERT_TRUE(segment_tissue(ct));
  const double per_voxel = (status_bytes("VmHWM") - before) / double(ct.grid.voxel_count());
  RecordProperty("bytes_per_voxel", std::to_string(per_voxel));
  EXPECT_LT(per_voxel, kDocumentedBytes);
  EXPECT_GT(per_voxel, 0.3 * kDocumentedBytes) << "document less";
}

TEST(SegmentTissue, StopsOnRequest) {
  class Stop : public Progress {
   public:
    [[nodiscard]] bool stop_requested() const override { return true; }
  } stop;
  const auto result = segment_tissue(scan(), {}, stop);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::kCancelled);
}

}  // namespace
}  // namespace lefort::anatomy::test_segment_tissue
