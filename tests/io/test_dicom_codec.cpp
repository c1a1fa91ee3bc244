#include <lefort/io/internal/descriptor.h>
#include <lefort/io/internal/dicom_codec.h>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>
#include <filesystem>

#include "io/dicom_writer.h"
#include "io/sample_scan.h"
#include "support/stop_at_once.h"
#include "support/temporary_folder.h"
#include "support/text.h"

namespace lefort::io::test_dicom_codec {
namespace {

using test::contains;
using test::dicom_slices;
using test::DicomSlice;
using test::sample_scan;
using test::TemporaryFolder;
using test::write_dicom;

/// Decoding of a compressed slice.
class DicomCodec : public ::testing::Test {
 protected:
  void SetUp() override {
    write_dicom(file_, dicom_slices(sample_scan())[2]);
    test::compress_dicom(file_);
  }
  [[nodiscard]] std::string error_message(const ReaderLimits& limits, ErrorCode code,
                                          Progress& progress = Progress::none()) const {
    const auto result = decode_dicom_pixels(file_, 35, progress, limits);
    if (result) return "decoded";
    EXPECT_EQ(result.error().code, code);
    return result.error().message;
  }
  TemporaryFolder folder_;
  std::filesystem::path file_ = folder_ / "slice.dcm";
};

TEST_F(DicomCodec, DecodesWithinItsLimits) {
  const auto found = decode_dicom_pixels(file_, 35);
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ((*found)[1], -1000 + 14 * 71 + 1024);
}

TEST_F(DicomCodec, StopsACodecThatNeedsTooMuchMemory) {
  DicomSlice large = dicom_slices(sample_scan())[2];
  // So large that malloc maps new memory instead of reusing freed memory.
  large.columns = large.rows = 4096;
  large.stored.assign(4096 * 4096, 7);
  write_dicom(file_, large);
  test::compress_dicom(file_);
  ASSERT_TRUE(decode_dicom_pixels(file_, 4096 * 4096));
  const auto result =
      decode_dicom_pixels(file_, 4096 * 4096, Progress::none(), {.memory_bytes = 1 << 20});
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::kFileCorrupt);
}

TEST_F(DicomCodec, StopsACodecThatHangs) {
  std::filesystem::remove(file_);
  ASSERT_EQ(::mkfifo(file_.c_str(), 0600), 0);
  const Descriptor writer(
      ::open(file_.c_str(), O_RDWR | O_CLOEXEC));  // Writes nothing: reads wait.
  EXPECT_TRUE(
      contains(error_message({.time = std::chrono::milliseconds(50)}, ErrorCode::kFileCorrupt),
               "longer than 50 ms"));
  test::StopAtOnce progress;
  EXPECT_TRUE(contains(error_message({}, ErrorCode::kCancelled, progress), "stopped"));
}

}  // namespace
}  // namespace lefort::io::test_dicom_codec
