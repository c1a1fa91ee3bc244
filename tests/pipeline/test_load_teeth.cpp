/// \file
/// Tooth maps of plans: a block of bone with two teeth in it.
#include <lefort/io/segmentation_file.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/prepare/load_teeth.h>

#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "support/temporary_folder.h"

namespace lefort::pipeline::test_load_teeth {
namespace {

using anatomy::Tissue;
using Numbers = image::Volume<std::uint8_t>;

ScannedHead head() {
  ScannedHead made;
  made.labels.grid.size = {30, 20, 30};
  made.labels.values.assign(std::size_t(made.labels.grid.voxel_count()), Tissue::kSoftTissue);
  for (Index k = 0; k < 25; ++k)
    for (Index j = 0; j < 20; ++j)
      for (Index i = 0; i < 30; ++i) made.labels.at(i, j, k) = Tissue::kBone;
  made.scan.ct.grid = made.labels.grid;
  return made;
}

/// Teeth of 6 x 6 x 20 mm, the first with `first`.
Numbers teeth(std::uint8_t first, std::uint8_t second, Index lowest = 2) {
  Numbers made{head().labels.grid, {}};
  made.values.assign(std::size_t(made.grid.voxel_count()), 0);
  for (Index k = lowest; k < lowest + 20; ++k)
    for (Index j = 5; j < 11; ++j)
      for (Index i = 0; i < 6; ++i) {
        made.at(i + 4, j, k) = first;
        made.at(i + 14, j, k) = second;
      }
  return made;
}

class LoadTeeth : public testing::Test {
 protected:
  [[nodiscard]] Result<std::optional<predict::JawTeeth>> load(const Numbers& map) const {
    EXPECT_TRUE(io::write_numbered_teeth(folder_ / "teeth.seg.nrrd", map));
    return load();
  }
  [[nodiscard]] Result<std::optional<predict::JawTeeth>> load() const {
    io::PlanFile plan;
    plan.teeth_source = io::TeethSource::kFile;
    plan.teeth = folder_ / "teeth.seg.nrrd";
    return load_teeth(plan, head(), Progress::none());
  }
  test::TemporaryFolder folder_;
};

TEST_F(LoadTeeth, ReadsNumbersAndWithoutATeethSourceUsesNone) {
  const auto found = load(teeth(12, 11));
  ASSERT_TRUE(found) << found.error().message;
  ASSERT_TRUE(found->has_value());
  EXPECT_EQ((*found)->numbers.values, teeth(12, 11).values);
  ASSERT_EQ((*found)->teeth.size(), 2U);
  EXPECT_EQ((*found)->teeth[0].fdi, 11);
  EXPECT_EQ((*found)->teeth[1].fdi, 12);
  const auto none = load_teeth({}, head(), Progress::none());
  ASSERT_TRUE(none);
  EXPECT_FALSE(none->has_value());
}

TEST_F(LoadTeeth, AMapOfAnotherGridIsAnErrorOfOneLine) {
  Numbers other = teeth(12, 11);
  other.grid.spacing_mm *= 1.3;
  const auto found = load(other);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::kFileCorrupt);
  EXPECT_EQ(found.error().message,
            "segmentation.teeth " + (folder_ / "teeth.seg.nrrd").string() +
                ": tooth map: the voxels do not coincide with those of the scan; make it from this "
                "scan (`lefort segment` or `lefort dental teeth`)");
}

TEST_F(LoadTeeth, TeethOutsideTheBoneOfTheLabelsAreAnError) {
  const auto found = load(teeth(12, 11, 10));  // 5 of 20 layers lie in soft tissue.
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::kPlanInvalid);
  EXPECT_NE(
      found.error().message.find("75 % of their voxels are bone in the labels, expected 90 %"),
      std::string::npos)
      << found.error().message;
}

TEST_F(LoadTeeth, OtherNamesAndMapsWithoutNumbersOrLandmarksAreErrors) {
  ASSERT_TRUE(io::write_segmentation(folder_ / "teeth.seg.nrrd", head().labels));
  const auto labels = load();
  ASSERT_FALSE(labels);
  EXPECT_EQ(labels.error().code, ErrorCode::kFileUnsupported);
  EXPECT_NE(
      labels.error().message.find("expected upper teeth, lower teeth or tooth 11 to tooth 48"),
      std::string::npos)
      << labels.error().message;

  anatomy::ToothMap jaws{head().labels.grid, {}};
  for (const std::uint8_t value : teeth(1, 1).values) jaws.values.push_back(anatomy::Tooth(value));
  ASSERT_TRUE(io::write_teeth(folder_ / "teeth.seg.nrrd", jaws));
  const auto jaw_map = load();
  ASSERT_FALSE(jaw_map);
  EXPECT_EQ(jaw_map.error().code, ErrorCode::kPlanInvalid);
  EXPECT_NE(jaw_map.error().message.find("no landmark N, ANS or A"), std::string::npos);
}

}  // namespace
}  // namespace lefort::pipeline::test_load_teeth
