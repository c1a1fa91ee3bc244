#include <lefort/pipeline/import.h>

#include <gtest/gtest.h>

#include <cstddef>
#include <filesystem>
#include <iterator>

#include "support/temporary_folder.h"

namespace lefort::pipeline::test_make_phantom {
namespace {

namespace fs = std::filesystem;

TEST(MakePhantom, AHeadWithTeethHasSlicesLabelsAndLandmarks) {
  for (const PhantomHead head : {PhantomHead::kTeeth, PhantomHead::kOpenBite}) {
    const test::TemporaryFolder folder;
    const PhantomJob job{
        .output = folder / "head", .head = head, .voxel_mm = 5.0, .noise_hu = 30.0};
    const auto summary = make_phantom(job, Progress::none());
    ASSERT_TRUE(summary) << summary.error().message;
    const auto slices =
        std::distance(fs::directory_iterator(folder / "head/dicom"), fs::directory_iterator());
    EXPECT_EQ(summary->json["slices"].get<std::ptrdiff_t>(), slices);
    EXPECT_TRUE(fs::exists(folder / "head/labels.seg.nrrd"));
    EXPECT_TRUE(fs::exists(folder / "head/landmarks.mrk.json"));
    const auto imported = import_scan(
        {.source = folder / "head/dicom", .output = folder / "ct.nrrd"}, Progress::none());
    ASSERT_TRUE(imported) << imported.error().message;
  }
}

TEST(MakePhantom, AHeadWithTeethHasOnlyPlainSlices) {
  const test::TemporaryFolder folder;
  for (const auto variant : {PhantomVariant::kTilted, PhantomVariant::kShuffled,
                             PhantomVariant::kOblique, PhantomVariant::kFeetFirst}) {
    const PhantomJob job{
        .output = folder / "head", .head = PhantomHead::kTeeth, .variant = variant};
    const auto summary = make_phantom(job, Progress::none());
    ASSERT_FALSE(summary);
    EXPECT_EQ(summary.error().code, ErrorCode::kInvalidArgument);
    EXPECT_FALSE(fs::exists(folder / "head"));
  }
}

}  // namespace
}  // namespace lefort::pipeline::test_make_phantom
