#include <lefort/io/dicom.h>
#include <lefort/io/volume_files.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "io/dicom_series.h"
#include "io/dicom_writer.h"
#include "io/sample_scan.h"
#include "support/stop_at_once.h"
#include "support/temporary_folder.h"
#include "support/text.h"

namespace lefort::io::test_dicom {
namespace {

using test::contains;
using test::dicom_slices;
using test::DicomSlice;
using test::expect_same_in_patient;
using test::oblique;
using test::sample_scan;
using test::series_error;
using test::sheared;
using test::TemporaryFolder;
using test::write_dicom;
using test::write_dicom_series;

TEST(Dicom, ReadsAnAxialScan) {
  const TemporaryFolder folder;
  const auto ct = sample_scan();
  write_dicom_series(folder.path(), dicom_slices(ct));
  const auto found = read_dicom_series(folder.path());
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->ct.values, ct.values);
  test::expect_same_grid(found->ct.grid, ct.grid, 1e-7);
  EXPECT_EQ(found->source_kind, "DICOM series");
  EXPECT_TRUE(found->warnings.empty()) << found->warnings.front();
}

TEST(Dicom, PreservesThePositionOfAnObliqueStack) {
  const TemporaryFolder folder;
  const auto ct = sample_scan(oblique());
  write_dicom_series(folder.path(), dicom_slices(ct));
  const auto found = read_dicom_series(folder.path());
  ASSERT_TRUE(found) << found.error().message;
  expect_same_in_patient(found->ct, ct);
}

TEST(Laterality, DicomSlicesInAnyScanDirectionKeepTheirPosition) {
  Mat3 prone, coronal, sagittal;
  prone << -1, 0, 0, 0, -1, 0, 0, 0, 1;
  coronal << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  sagittal << 0, 0, -1, 1, 0, 0, 0, -1, 0;
  for (const Mat3& direction : {prone, coronal, sagittal}) {
    const TemporaryFolder folder;
    const auto ct = sample_scan(direction);
    auto slices = dicom_slices(ct);
    std::reverse(slices.begin(), slices.end());
    write_dicom_series(folder.path(), slices);
    const auto found = read_dicom_series(folder.path());
    ASSERT_TRUE(found) << found.error().message;
    expect_same_in_patient(found->ct, ct);
  }
}

TEST(Dicom, NamesAndOrderOfFilesDoNotMatter) {
  const TemporaryFolder folder;
  const auto ct = sample_scan();
  const auto slices = dicom_slices(ct);
  for (std::size_t n = 0; n < slices.size(); ++n)
    write_dicom(folder / fmt::format("{}", (n * 5 + 3) % 7), slices[n]);
  const auto found = read_dicom_series(folder.path());
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->ct.values, ct.values);
}

TEST(Dicom, AppliesSlopeAndInterceptOfEachSlice) {
  const TemporaryFolder folder;
  const auto ct = sample_scan();  // All HU are even.
  auto slices = dicom_slices(ct, 2.0, -1000.0);
  slices[3] = dicom_slices(ct, 0.5, -500.0)[3];
  write_dicom_series(folder.path(), slices);
  const auto found = read_dicom_series(folder.path());
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->ct.values, ct.values);
}

TEST(Dicom, ReadsEveryLosslessCodecOfSignedAndUnsignedPixels) {
  using test::Codec;
  // Codecs need more pixels than the sample scan has.
  image::CtVolume ct{{.size = {64, 48, 2}, .spacing_mm = {0.5, 0.5, 1.0}}, {}};
  for (Index n = 0; n < ct.grid.voxel_count(); ++n)
    ct.values.push_back(static_cast<std::int16_t>(-1000 + (n * n / 7) % 4000));
  for (const Codec codec : {Codec::kJpegLossless, Codec::kJpegLs, Codec::kJpeg2000, Codec::kRle})
    for (const bool is_signed : {true, false}) {
      SCOPED_TRACE(fmt::format("codec {}, {}", int(codec), is_signed ? "signed" : "unsigned"));
      const TemporaryFolder folder;
      auto slices = dicom_slices(ct);
      for (DicomSlice& slice : slices) slice.is_signed = is_signed;
      write_dicom_series(folder.path(), slices);
      for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
        test::compress_dicom(entry.path(), codec);
      const auto found = read_dicom_series(folder.path());
      ASSERT_TRUE(found) << found.error().message;
      EXPECT_EQ(found->ct.values, ct.values);
    }
}

TEST(Dicom, ReadsSignedAndUnsignedPixelsWithFewerBits) {
  const auto ct = sample_scan();
  for (const bool is_signed : {true, false}) {
    const TemporaryFolder folder;
    auto slices = dicom_slices(ct, 1.0, is_signed ? 500.0 : -1024.0);
    for (DicomSlice& slice : slices) {
      slice.is_signed = is_signed;
      slice.bits_stored = 12;  // The bits above them may have any value.
      for (std::int16_t& value : slice.stored)
        value = static_cast<std::int16_t>((value & 0x0fff) | 0x5000);
    }
    write_dicom_series(folder.path(), slices);
    const auto found = read_dicom_series(folder.path());
    ASSERT_TRUE(found) << found.error().message;
    EXPECT_EQ(found->ct.values, ct.values) << is_signed;
  }
}

TEST(Dicom, MessagesContainNoFileOrFolderName) {
  const TemporaryFolder folder;
  const auto study = folder / "DOE_JANE_19610412";
  const auto expect_error_without_names = [&](const std::string& part) {
    const auto result = read_dicom_series(study);
    ASSERT_FALSE(result);
    EXPECT_TRUE(contains(result.error().message, part)) << result.error().message;
    EXPECT_FALSE(contains(result.error().message, "DOE")) << result.error().message;
    EXPECT_FALSE(contains(result.error().message, "tmp")) << result.error().message;
  };
  expect_error_without_names("the folder cannot be listed");
  std::filesystem::create_directory(study);
  expect_error_without_names("has no DICOM files");
  const auto fill = [&](auto slices) {
    std::filesystem::remove_all(study);
    std::filesystem::create_directory(study);
    for (std::size_t k = 0; k < slices.size(); ++k)
      write_dicom(study / fmt::format("DOE_{}.dcm", k), slices[k]);
  };
  const auto fresh = dicom_slices(sample_scan());
  auto slices = fresh;
  for (DicomSlice& slice : slices) slice.modality = "MR";
  fill(slices);
  expect_error_without_names("has no CT series");
  fill(std::vector<DicomSlice>(fresh.begin() + 1, fresh.end()));
  const std::string whole = test::bytes_of(study / "DOE_3.dcm");
  test::write_bytes(study / "DOE_3.dcm", whole.substr(0, whole.size() - 20));
  expect_error_without_names("file 4");
  slices = fresh;
  for (DicomSlice& slice : slices) slice.instance_number = "";
  slices[2].position = "";
  fill(slices);
  expect_error_without_names("DICOM file 3: the image position is missing");
}

TEST(Dicom, OutputsContainNoPatientData) {
  const TemporaryFolder folder;
  auto slices = dicom_slices(sample_scan());
  for (DicomSlice& slice : slices) {
    slice.patient_id = "MRN-4711";
    slice.birth_date = "19610412";
    slice.comment = "fell off a horse";
    slice.kernel = "DOE^JANE";
  }
  write_dicom_series(folder / "DOE_JANE", slices);
  const std::vector<std::string> secrets{"DOE", "JANE", "4711", "19610412", "horse", "1.2.826"};
  ASSERT_TRUE(contains(test::bytes_of(folder / "DOE_JANE/slice-000.dcm"), "fell off a horse"));
  const auto scan = read_dicom_series(folder / "DOE_JANE");
  ASSERT_TRUE(scan) << scan.error().message;
  std::string all = scan->source_kind;
  for (const std::string& warning : scan->warnings) all += warning;
  const auto list = list_dicom_series(folder / "DOE_JANE");
  ASSERT_TRUE(list) << list.error().message;
  for (const DicomSeriesInfo& info : *list)
    all += info.modality + info.kernel + info.orientation + info.problem;
  std::filesystem::create_directory(folder / "out");
  for (const char* const name : {"ct.nrrd", "ct.nii", "ct.mha"}) {
    ASSERT_TRUE(write_volume(folder / (std::string("out/") + name), scan->ct));
    all += test::bytes_of(folder / (std::string("out/") + name));
  }
  for (const std::string& secret : secrets) EXPECT_FALSE(contains(all, secret)) << secret;
}

TEST(Dicom, IgnoresForeignFilesWithAWarning) {
  const TemporaryFolder folder;
  write_dicom_series(folder.path(), dicom_slices(sample_scan()));
  test::write_bytes(folder / "README.txt", "JANE DOE");
  test::write_bytes(folder / "empty", "");
  std::filesystem::create_directory(folder / "DOE");
  const auto found = read_dicom_series(folder.path());
  ASSERT_TRUE(found) << found.error().message;
  ASSERT_EQ(found->warnings.size(), 1U);
  EXPECT_EQ(found->warnings[0], "2 files are not DICOM images and were ignored");
}

TEST(Dicom, SelectsTheOnlyCtAmongOtherSeries) {
  const TemporaryFolder folder;
  const auto ct = sample_scan();
  write_dicom_series(folder.path(), dicom_slices(ct));
  DicomSlice plan;
  plan.series_uid = "1.2.3.4";
  plan.modality = "RTSTRUCT";
  write_dicom(folder / "plan.dcm", plan);
  DicomSlice scout = dicom_slices(ct)[0];
  scout.series_uid = "1.2.3.5";
  scout.image_type = "ORIGINAL\\PRIMARY\\LOCALIZER";
  write_dicom(folder / "scout.dcm", scout);
  const auto found = read_dicom_series(folder.path());
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->ct.values, ct.values);
  EXPECT_EQ(found->warnings, std::vector<std::string>{"2 other series were ignored"});
}

TEST(Dicom, IgnoresDamagedFilesOfOtherSeries) {
  const TemporaryFolder folder;
  const auto ct = sample_scan();
  write_dicom_series(folder.path(), dicom_slices(ct));
  DicomSlice scout = dicom_slices(ct)[0];
  scout.series_uid = "1.2.3.5";
  scout.image_type = "ORIGINAL\\PRIMARY\\LOCALIZER";
  write_dicom(folder / "scout.dcm", scout);
  const std::string whole = test::bytes_of(folder / "scout.dcm");
  test::write_bytes(folder / "scout.dcm", whole.substr(0, whole.size() - 20));
  const auto known = read_dicom_series(folder.path());
  ASSERT_TRUE(known) << known.error().message;
  EXPECT_EQ(known->ct.values, ct.values);
  EXPECT_EQ(known->warnings, (std::vector<std::string>{"1 other series were ignored",
                                                       "1 of their files are damaged"}));

  test::write_bytes(folder / "scout.dcm",
                    whole.substr(0, 200));  // Truncated before the tag of its series.
  const auto unknown = read_dicom_series(folder.path());
  ASSERT_TRUE(unknown) << unknown.error().message;
  EXPECT_EQ(unknown->ct.values, ct.values);
  ASSERT_EQ(unknown->warnings.size(), 1U);
  EXPECT_TRUE(contains(unknown->warnings[0], "1 DICOM files cannot be read"))
      << unknown->warnings[0];
  EXPECT_TRUE(contains(unknown->warnings[0], "DICOM file 1: it is truncated"))
      << unknown->warnings[0];
}

TEST(Dicom, RejectsADamagedFileAtTheEndOfTheSeries) {
  const TemporaryFolder folder;
  write_dicom_series(folder.path(), dicom_slices(sample_scan()));
  const std::string whole = test::bytes_of(folder / "slice-005.dcm");
  test::write_bytes(folder / "slice-005.dcm", whole.substr(0, whole.size() - 20));
  const auto result = read_dicom_series(folder.path());
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::kFileCorrupt);
  EXPECT_TRUE(contains(result.error().message, "slice 16 (file 6)")) << result.error().message;
}

TEST(Dicom, NamesTheUnreadableFileIfASliceIsMissing) {
  const TemporaryFolder folder;
  write_dicom_series(folder.path(), dicom_slices(sample_scan()));
  test::write_bytes(folder / "slice-002.dcm", "");
  const auto result = read_dicom_series(folder.path());
  ASSERT_FALSE(result);
  EXPECT_TRUE(contains(result.error().message, "1 slices are missing")) << result.error().message;
  EXPECT_TRUE(contains(result.error().message, "DICOM file 3: it is truncated"))
      << result.error().message;
}

TEST(Dicom, RequiresAChoiceAmongSeveralCts) {
  const TemporaryFolder folder;
  const auto ct = sample_scan();
  auto second = dicom_slices(ct, 1.0, -1000.0);
  for (DicomSlice& slice : second) {
    slice.series_uid += ".7";
    slice.instance_uid += ".7";
    for (std::int16_t& value : slice.stored) value = static_cast<std::int16_t>(value / 2);
  }
  write_dicom_series(folder / "a", dicom_slices(ct));
  write_dicom_series(folder / "b", second);
  for (const auto& entry : std::filesystem::directory_iterator(folder / "b"))
    std::filesystem::rename(entry.path(),
                            folder / "a" / ("other-" + entry.path().filename().string()));

  const auto either = read_dicom_series(folder / "a");
  ASSERT_FALSE(either);
  EXPECT_EQ(either.error().code, ErrorCode::kInvalidArgument);
  EXPECT_TRUE(contains(either.error().message, "1 = CT, 7 x 5, 6 images; 2 = CT, 7 x 5, 6 images"))
      << either.error().message;
  EXPECT_FALSE(contains(either.error().message, "1.2.826"));
  EXPECT_EQ(read_dicom_series(folder / "a", 1)->ct.values, ct.values);
  EXPECT_EQ(read_dicom_series(folder / "a", 2)->ct.values[1], -993);
  for (const int series : {-1, 3})
    EXPECT_EQ(read_dicom_series(folder / "a", series).error().code, ErrorCode::kInvalidArgument);
}

TEST(Dicom, ReportsAFolderWithoutCtOrDicom) {
  const TemporaryFolder folder;
  EXPECT_TRUE(contains(read_dicom_series(folder.path()).error().message, "no DICOM files"));
  auto slices = dicom_slices(sample_scan());
  for (DicomSlice& slice : slices) slice.modality = "MR";
  EXPECT_TRUE(contains(series_error(slices, ErrorCode::kFileUnsupported), "1 = MR"));
  for (DicomSlice& slice : slices) slice.modality = "JANE DOE";
  EXPECT_TRUE(contains(series_error(slices, ErrorCode::kFileUnsupported), "1 = unknown"));
  EXPECT_EQ(read_dicom_series(folder / "none").error().code, ErrorCode::kFileNotFound);
}

TEST(Dicom, RejectsAScanWithManyUnreadableFiles) {
  const TemporaryFolder folder;
  write_dicom_series(folder.path(), dicom_slices(sample_scan()));
  for (const char* const name : {"slice-003.dcm", "slice-004.dcm", "slice-005.dcm"})
    test::write_bytes(folder / name, "");
  const auto half = read_dicom_series(folder.path());
  ASSERT_FALSE(half);
  EXPECT_EQ(half.error().code, ErrorCode::kFileCorrupt);
  EXPECT_TRUE(
      contains(half.error().message, "3 DICOM files cannot be read in addition to 3 slices"))
      << half.error().message;
  test::expect_one_sentence(half.error().message);
}

TEST(Dicom, ListsTheSeriesOfAFolderAndItsSubfolders) {
  const TemporaryFolder folder;
  auto ct = dicom_slices(sample_scan(oblique()));
  for (DicomSlice& slice : ct) slice.kernel = "H60s";
  write_dicom_series(folder / "PAT/ST0/SE0", ct);
  auto other = sheared(0.3);
  for (DicomSlice& slice : other) slice.series_uid = "1.2.9", slice.kernel = "JANE DOE";
  write_dicom_series(folder / "PAT/ST0/SE1", other);
  DicomSlice plan;
  plan.series_uid = "1.2.3.4";
  plan.modality = "RTSTRUCT";
  write_dicom(folder / "plan.dcm", plan);
  auto gap = dicom_slices(sample_scan());
  gap.erase(gap.begin() + 2);
  for (DicomSlice& slice : gap) slice.series_uid = "1.2.99";
  write_dicom_series(folder / "gap", gap);

  const auto list = list_dicom_series(folder.path());
  ASSERT_TRUE(list) << list.error().message;
  ASSERT_EQ(list->size(), 4U);
  const DicomSeriesInfo& first = (*list)[1];  // Sorted by identifier.
  EXPECT_EQ(first.number, 2);
  EXPECT_EQ(first.modality, "CT");
  EXPECT_EQ(first.images, 6);
  EXPECT_EQ(first.columns, 7);
  EXPECT_EQ(first.rows, 5);
  EXPECT_EQ(first.kernel, "H60s");
  EXPECT_EQ(first.pixel_mm, (std::array{0.4, 0.5}));
  EXPECT_NEAR(first.step_mm.value(), 1.25, 1e-6);
  EXPECT_TRUE(first.is_usable && first.warnings.empty());
  EXPECT_EQ((*list)[0].problem, "not a CT");
  EXPECT_FALSE((*list)[0].is_usable);
  EXPECT_EQ((*list)[2].kernel, "");
  EXPECT_TRUE((*list)[2].is_usable);
  EXPECT_TRUE(contains((*list)[2].warnings.at(0), "sheared"));
  EXPECT_TRUE(contains((*list)[3].problem, "missing"));
  // The listed number selects the same series for reading.
  EXPECT_TRUE(read_dicom_series(folder.path(), 3));
  EXPECT_TRUE(contains(read_dicom_series(folder.path(), 4).error().message, "missing"));
  EXPECT_FALSE(list_dicom_series(folder / "none"));
}

TEST(Dicom, NamesATruncatedFileOfAnyLength) {
  for (const bool compressed : {false, true}) {
    const TemporaryFolder folder;
    const auto ct = sample_scan();
    write_dicom_series(folder.path(), dicom_slices(ct));
    const auto damaged = folder / "slice-004.dcm";
    if (compressed) test::compress_dicom(damaged);
    const std::string whole = test::bytes_of(damaged);
    ::testing::internal::CaptureStderr();
    for (std::size_t length = 0; length < whole.size(); length += 1 + length / 40) {
      test::write_bytes(damaged, whole.substr(0, length));
      const auto result = read_dicom_series(folder.path());
      // The last bytes of a JPEG stream are padding; without them the scan is complete.
      if (result && compressed && result->ct.values == ct.values) continue;
      ASSERT_FALSE(result) << length << " of " << whole.size();
      test::expect_one_sentence(result.error().message);
      EXPECT_TRUE(contains(result.error().message, "file 5") ||
                  contains(result.error().message, "1 slices are missing"))
          << length << ": " << result.error().message;
    }
    EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  }
}

TEST(Dicom, StopsOnRequest) {
  const TemporaryFolder folder;
  write_dicom_series(folder.path(), dicom_slices(sample_scan()));
  test::StopAtOnce progress;
  EXPECT_EQ(read_dicom_series(folder.path(), 0, progress).error().code, ErrorCode::kCancelled);
}

}  // namespace
}  // namespace lefort::io::test_dicom
