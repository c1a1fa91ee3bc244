#include <lefort/core/parallel.h>
#include <lefort/io/volume_files.h>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "io/itk_images.h"
#include "io/sample_scan.h"
#include "support/temporary_folder.h"

namespace lefort::io::test_volume_files {
namespace {

using test::bytes_of;
using test::expect_same_grid;
using test::oblique;
using test::sample_scan;
using test::TemporaryFolder;

class EveryFormat : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(VolumeFiles, EveryFormat,
                         ::testing::Values("a.nrrd", "a.nii.gz", "a.nii", "a.mha"),
                         [](const auto& format) {
                           std::string name = format.param;
                           std::erase(name, '.');
                           return name;
                         });

TEST_P(EveryFormat, ReadsBackAnObliqueScan) {
  const TemporaryFolder folder;
  const auto ct = sample_scan(oblique());
  ASSERT_TRUE(write_volume(folder / GetParam(), ct));
  EXPECT_EQ(folder.entry_count(), 1);
  const auto found = read_volume(folder / GetParam());
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->ct.values, ct.values);
  // NIfTI stores the position as 32-bit floats; the text of the others is more precise.
  expect_same_grid(found->ct.grid, ct.grid, 2e-6);
  EXPECT_TRUE(found->warnings.empty());
}

TEST_P(EveryFormat, EqualVolumesGiveEqualBytes) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_volume(folder / GetParam(), sample_scan(oblique())));
  const std::string first = bytes_of(folder / GetParam());
  ASSERT_TRUE(write_volume(folder / GetParam(), sample_scan(oblique())));
  EXPECT_EQ(bytes_of(folder / GetParam()), first);
}

TEST_P(EveryFormat, PreservesFractionsOfAScalarVolume) {
  const TemporaryFolder folder;
  const image::ScalarVolume volume{{.size = {1, 2, 3}}, {0.25F, -7.75F, 0.0F, 3.0F, 4.0F, -900.4F}};
  ASSERT_TRUE(write_volume(folder / GetParam(), volume));
  const auto found = read_volume(folder / GetParam());
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->ct.values, (std::vector<std::int16_t>{0, -8, 0, 3, 4, -900}));
}

TEST_P(EveryFormat, ClampsValuesToTheRangeOfACtWithAWarning) {
  const TemporaryFolder folder;
  // The NIfTI library converts non-finite values to 0, so they are rejected: see
  // test_volume_headers.cpp.
  const bool keeps_nan = std::string(GetParam()).find(".nii") == std::string::npos;
  const float nan = keeps_nan ? std::numeric_limits<float>::quiet_NaN() : -9999.0F;
  const float inf = keeps_nan ? std::numeric_limits<float>::infinity() : 9999.0F;
  const image::ScalarVolume volume{
      {.size = {3, 2, 2}}, {nan, inf, -inf, 1e30F, -3024.0F, 3071.0F, -1024.0F, 0, 0, nan, 0, 0}};
  ASSERT_TRUE(write_volume(folder / GetParam(), volume));
  const auto found = read_volume(folder / GetParam());
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->ct.values, (std::vector<std::int16_t>{-1024, 3071, -1024, 3071, -1024, 3071,
                                                         -1024, 0, 0, -1024, 0, 0}));
  ASSERT_EQ(found->warnings.size(), keeps_nan ? 2U : 1U);
  EXPECT_EQ(found->warnings[0].substr(0, 14), keeps_nan ? "4 of 12 voxels" : "6 of 12 voxels");
  if (keeps_nan) {
    EXPECT_EQ(found->warnings[1].substr(0, 14), "2 of 12 voxels");
  }
}

TEST_P(EveryFormat, RejectsAnUnwritableFolderAndLeavesNothing) {
  const auto lost = write_volume(std::filesystem::path("/nonexistent") / GetParam(), sample_scan());
  EXPECT_EQ(lost.error().code, ErrorCode::kFileUnwritable);
}

/// Limits files to 100 bytes while it lives, as on a full disk.
class FullDisk {
 public:
  FullDisk() : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit full{100, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &full);
  }
  ~FullDisk() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  void (*handler_)(int);
  rlimit before_{};
};

TEST_P(EveryFormat, ReportsAFullDiskAndLeavesNothing) {
  const TemporaryFolder folder;
  const auto scan = sample_scan();
  const auto lost = [&] {
    const FullDisk full;
    return write_volume(folder / GetParam(), scan);
  }();
  ASSERT_FALSE(lost);
  EXPECT_EQ(lost.error().code, ErrorCode::kFileUnwritable);
  test::expect_one_sentence(lost.error().message);
  EXPECT_EQ(folder.entry_count(), 0);
}

TEST(VolumeFiles, WarnsOfValuesThatAreProbablyNotHounsfieldUnits) {
  const TemporaryFolder folder;
  auto ct = sample_scan();
  for (auto& value : ct.values) value = static_cast<std::int16_t>(value + 1024);
  ASSERT_TRUE(write_volume(folder / "a.nrrd", ct));
  const auto found = read_volume(folder / "a.nrrd");
  ASSERT_EQ(found->warnings.size(), 1U);
  EXPECT_NE(found->warnings[0].find("may not be in HU"), std::string::npos);
}

TEST(VolumeFiles, WarnsOfAFieldOfViewThatEndsInThePatient) {
  const TemporaryFolder folder;
  image::CtVolume ct{{.size = {40, 40, 4}}, {}};
  ct.values.assign(40 * 40 * 4, -1000);
  for (Index k = 0; k < 4; ++k)
    for (Index j = 10; j < 30; ++j)
      for (Index i = 10; i < 30; ++i) ct.at(i, j, k) = 40;
  ASSERT_TRUE(write_volume(folder / "a.nrrd", ct));
  const auto cut = read_volume(folder / "a.nrrd");
  ASSERT_EQ(cut->warnings.size(), 1U);
  EXPECT_NE(cut->warnings[0].find("ends in tissue over 3.2 cm2"), std::string::npos)
      << cut->warnings[0];
  for (Index k = 0; k < 4; ++k)  // With half air and half tissue, as at skin.
    for (Index n = 9; n < 31; ++n)
      for (const Index side : {9, 30}) ct.at(n, side, k) = ct.at(side, n, k) = -480;
  ASSERT_TRUE(write_volume(folder / "a.nrrd", ct));
  EXPECT_TRUE(read_volume(folder / "a.nrrd")->warnings.empty());
}

/// 2.6 MB: three blocks of io/internal/write_nrrd.cpp.
image::CtVolume large_scan() {
  image::CtVolume ct;
  ct.grid.size = {130, 100, 100};
  ct.grid.spacing_mm = Vec3(0.3, 0.4, 1.0 / 3.0);
  std::uint32_t state = 1;
  for (Index v = 0; v < ct.grid.voxel_count(); ++v) {
    state = state * 1664525U + 1013904223U;
    ct.values.push_back(std::int16_t(int(state >> 24U) - 128));
  }
  return ct;
}

TEST(VolumeFiles, OtherReadersReadAnNrrdFileOfSeveralBlocks) {
  const TemporaryFolder folder;
  const image::CtVolume ct = large_scan();
  ASSERT_TRUE(write_volume(folder / "a.nrrd", ct));
  const test::ItkImage read = test::read_itk_image((folder / "a.nrrd").string());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(read.size[axis], std::size_t(ct.grid.size[axis]));
    EXPECT_NEAR(read.spacing[axis], ct.grid.spacing_mm[Index(axis)], 1e-15);
  }
  ASSERT_EQ(read.values.size(), ct.values.size());
  EXPECT_TRUE(std::equal(read.values.begin(), read.values.end(), ct.values.begin()));
}

TEST(VolumeFiles, NrrdFilesHaveTheSameBytesForAnyNumberOfThreads) {
  const TemporaryFolder folder;
  const image::CtVolume ct = large_scan();
  {
    const ThreadLimit one(1);
    ASSERT_TRUE(write_volume(folder / "a.nrrd", ct));
  }
  const ThreadLimit four(4);
  ASSERT_TRUE(write_volume(folder / "b.nrrd", ct));
  EXPECT_EQ(bytes_of(folder / "a.nrrd"), bytes_of(folder / "b.nrrd"));
}

TEST(VolumeFiles, RejectsOtherEndingsAndMissingFiles) {
  const TemporaryFolder folder;
  EXPECT_EQ(write_volume(folder / "a.png", sample_scan()).error().code,
            ErrorCode::kInvalidArgument);
  EXPECT_EQ(write_volume(folder / "a.nhdr", sample_scan()).error().code,
            ErrorCode::kInvalidArgument);
  EXPECT_EQ(folder.entry_count(), 0);
  EXPECT_EQ(read_volume(folder / "a.nrrd").error().code, ErrorCode::kFileNotFound);
  EXPECT_EQ(read_volume(folder / "a.png").error().code, ErrorCode::kFileUnsupported);
  EXPECT_TRUE(is_volume_file("A.NII.GZ"));
  EXPECT_FALSE(is_volume_file("a.gz"));
}

TEST(VolumeFiles, RejectsWritingAnInvalidGrid) {
  const TemporaryFolder folder;
  auto ct = sample_scan();
  ct.grid.direction.col(0) *= -1.0;
  EXPECT_EQ(write_volume(folder / "a.nrrd", ct).error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(folder.entry_count(), 0);
}

}  // namespace
}  // namespace lefort::io::test_volume_files
