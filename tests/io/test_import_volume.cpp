#include <lefort/io/import_volume.h>
#include <lefort/io/volume_files.h>

#include <gtest/gtest.h>

#include <random>

#include "io/dicom_writer.h"
#include "io/inv3_writer.h"
#include "io/sample_scan.h"
#include "support/temporary_folder.h"

namespace lefort::io::test_import_volume {
namespace {

using test::sample_scan;
using test::TemporaryFolder;

TEST(ImportVolume, ReadsEveryKindOfSource) {
  const TemporaryFolder folder;
  const auto kind = [&](const char* name) {
    const auto imported = import_volume(folder / name);
    return imported ? imported->source_kind : imported.error().message;
  };
  ASSERT_TRUE(write_volume(folder / "a.nrrd", sample_scan()));
  ASSERT_TRUE(write_volume(folder / "a.nii.gz", sample_scan()));
  ASSERT_TRUE(write_volume(folder / "a.mha", sample_scan()));
  test::write_dicom_series(folder / "dicom", test::dicom_slices(sample_scan()));
  test::write_gzip(folder / "a.inv3", test::inv3_archive(test::to_xml({}), test::inv3_matrix()));
  EXPECT_EQ(kind("a.nrrd"), "NRRD");
  EXPECT_EQ(kind("a.nii.gz"), "NIfTI");
  EXPECT_EQ(kind("a.mha"), "MetaImage");
  EXPECT_EQ(kind("dicom"), "DICOM series");
  EXPECT_EQ(kind("a.inv3"), "InVesalius project");
  EXPECT_EQ(import_volume(folder / "dicom", {.series = 2}).error().code,
            ErrorCode::kInvalidArgument);
}

TEST(ImportVolume, RejectsMissingAndUnknownSources) {
  const TemporaryFolder folder;
  EXPECT_EQ(import_volume(folder / "none").error().code, ErrorCode::kFileNotFound);
  test::write_bytes(folder / "a.stl", "solid");
  EXPECT_EQ(import_volume(folder / "a.stl").error().code, ErrorCode::kFileUnsupported);
}

TEST(ImportVolume, MessagesDoNotContainTheNameOfTheScan) {
  const TemporaryFolder folder;
  const auto expect_error_without_names = [&](const char* ending) {
    const auto result = import_volume(folder / (std::string("DOE^JANE") + ending));
    ASSERT_FALSE(result) << ending;
    test::expect_one_sentence(result.error().message);
    EXPECT_EQ(result.error().message.find("DOE"), std::string::npos) << result.error().message;
    EXPECT_EQ(result.error().message.find(folder.path().filename().string()), std::string::npos);
  };
  for (const char* const ending :
       {".nrrd", ".nhdr", ".nii", ".nii.gz", ".mha", ".mhd", ".inv3", ".stl", ""}) {
    expect_error_without_names(ending);  // Missing.
    test::write_bytes(folder / (std::string("DOE^JANE") + ending), "NRRD0004\nDOE^JANE\n");
    expect_error_without_names(ending);
  }
  test::write_gzip(folder / "DOE^JANE.inv3",
                   test::inv3_archive(test::to_xml({.dtype = "float64"}), test::inv3_matrix()));
  expect_error_without_names(".inv3");
  test::write_gzip(folder / "DOE^JANE.inv3",
                   test::inv3_archive(test::to_xml({}), test::inv3_matrix() + "xx"));
  expect_error_without_names(".inv3");
  test::write_gzip(folder / "DOE^JANE.inv3", test::tar_member("other", "x"));
  expect_error_without_names(".inv3");
}

/// A damaged file gives an error message of one sentence or, if the damage is irrelevant, the scan;
/// never a crash or terminal output.
class DamagedScan : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    const auto ct = sample_scan(test::oblique());
    const std::string name = GetParam();
    if (name == "a.inv3") {
      test::write_gzip(file(), test::inv3_archive(test::to_xml({}), test::inv3_matrix()));
    } else if (name == "dicom") {
      test::write_dicom_series(source(), test::dicom_slices(ct));
    } else if (name == "jpeg") {
      test::write_dicom_series(source(), test::dicom_slices(ct));
      test::compress_dicom(file());
    } else {
      ASSERT_TRUE(write_volume(file(), ct));
    }
    whole_ = test::bytes_of(file());
    const auto imported = import_volume(source());
    ASSERT_TRUE(imported) << imported.error().message;
    values_ = imported->ct.values;
    ::testing::internal::CaptureStderr();
    ::testing::internal::CaptureStdout();
  }
  void TearDown() override {
    EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
    EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
  }

  [[nodiscard]] std::filesystem::path source() const { return folder_ / GetParam(); }
  /// The damaged file; for a series, one slice.
  [[nodiscard]] std::filesystem::path file() const {
    return std::filesystem::is_directory(source()) ? source() / "slice-002.dcm" : source();
  }

  TemporaryFolder folder_;
  std::string whole_;
  std::vector<std::int16_t> values_;
};
INSTANTIATE_TEST_SUITE_P(ImportVolume, DamagedScan,
                         ::testing::Values("a.nrrd", "a.nii", "a.nii.gz", "a.mha", "a.inv3",
                                           "dicom", "jpeg"),
                         [](const auto& format) {
                           std::string name = format.param;
                           std::erase(name, '.');
                           return name;
                         });

TEST_P(DamagedScan, RejectsTruncationsOrReadsTheWholeScan) {
  int errors = 0;
  for (std::size_t length = 0; length < whole_.size(); length += 1 + length / 60) {
    test::write_bytes(file(), whole_.substr(0, length));
    const auto result = import_volume(source());
    if (result) {
      ASSERT_EQ(result->ct.values, values_) << length << " of " << whole_.size();
      continue;
    }
    ++errors;
    test::expect_one_sentence(result.error().message);
  }
  EXPECT_GT(errors, 60);
}

TEST_P(DamagedScan, RejectsOrReadsWrongBytes) {
  std::mt19937 random(20);
  int errors = 0;
  // Codecs trust the size in the stream, which takes time.
  const int attempts = std::string(GetParam()) == "jpeg" ? 40 : 150;
  for (int attempt = 0; attempt < attempts; ++attempt) {
    std::string bytes = whole_;
    for (int n = 0; n <= attempt % 4; ++n)  // Mostly in the header.
      bytes[random() % std::min<std::size_t>(bytes.size(), attempt % 2 == 0 ? 400 : 100'000)] =
          static_cast<char>(random());
    test::write_bytes(file(), bytes);
    const auto result = import_volume(source());
    if (result) continue;
    ++errors;
    test::expect_one_sentence(result.error().message);
  }
  EXPECT_GT(errors, 3);
}

TEST_P(DamagedScan, RejectsGarbage) {
  std::mt19937 random(21);
  for (const std::size_t size : {1U, 100U, 348U, 352U, 1000U, 5000U}) {
    std::string bytes(size, '\0');
    for (char& c : bytes) c = static_cast<char>(random());
    test::write_bytes(file(), bytes);
    const auto result = import_volume(source());
    ASSERT_FALSE(result);
    test::expect_one_sentence(result.error().message);
  }
}

}  // namespace
}  // namespace lefort::io::test_import_volume
