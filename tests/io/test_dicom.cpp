#include <lefort/io/dicom.h>
#include <lefort/io/internal/dicom_codec.h>
#include <lefort/io/volume_files.h>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>

#include "io/dicom_writer.h"
#include "io/sample_scan.h"
#include "support/temporary_folder.h"

namespace lefort::io {
namespace {

using test::dicom_slices;
using test::DicomSlice;
using test::expect_same_in_patient;
using test::oblique;
using test::sample_scan;
using test::TemporaryFolder;
using test::write_dicom;
using test::write_dicom_series;

/// The message of the error that reading `slices` gives.
std::string complaint(const std::vector<DicomSlice>& slices, ErrorCode code) {
  const TemporaryFolder folder;
  write_dicom_series(folder / "DOE^JANE", slices);
  const auto result = read_dicom_series(folder / "DOE^JANE");
  if (result) {
    ADD_FAILURE() << "no error";
    return "";
  }
  EXPECT_EQ(result.error().code, code) << result.error().message;
  test::expect_one_sentence(result.error().message);
  EXPECT_EQ(result.error().message.find("DOE"), std::string::npos);
  return result.error().message;
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(Dicom, GivesBackAnAxialScan) {
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

TEST(Dicom, KeepsAnObliqueStackInPlace) {
  const TemporaryFolder folder;
  const auto ct = sample_scan(oblique());
  write_dicom_series(folder.path(), dicom_slices(ct));
  const auto found = read_dicom_series(folder.path());
  ASSERT_TRUE(found) << found.error().message;
  expect_same_in_patient(found->ct, ct);
}

TEST(Laterality, DicomSlicesTakenFromHeadToFootOrCoronallyOrProneStayInPlace) {
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
  // Codecs want more pixels than the sample scan has.
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

TEST(Dicom, PixelsMayBeUnsignedOrSignedAndOfFewerBits) {
  const auto ct = sample_scan();
  for (const bool is_signed : {true, false}) {
    const TemporaryFolder folder;
    auto slices = dicom_slices(ct, 1.0, is_signed ? 500.0 : -1024.0);
    for (DicomSlice& slice : slices) {
      slice.is_signed = is_signed;
      slice.bits_stored = 12;  // What lies above them may be anything.
      for (std::int16_t& value : slice.stored)
        value = static_cast<std::int16_t>((value & 0x0fff) | 0x5000);
    }
    write_dicom_series(folder.path(), slices);
    const auto found = read_dicom_series(folder.path());
    ASSERT_TRUE(found) << found.error().message;
    EXPECT_EQ(found->ct.values, ct.values) << is_signed;
  }
}

TEST(Dicom, NoMessageHasTheNameOfAFileOrFolder) {
  const TemporaryFolder folder;
  const auto study = folder / "DOE_JANE_19610412";
  const auto expect_discreet = [&](const std::string& part) {
    const auto result = read_dicom_series(study);
    ASSERT_FALSE(result);
    EXPECT_TRUE(has(result.error().message, part)) << result.error().message;
    EXPECT_FALSE(has(result.error().message, "DOE")) << result.error().message;
    EXPECT_FALSE(has(result.error().message, "tmp")) << result.error().message;
  };
  expect_discreet("the folder cannot be listed");
  std::filesystem::create_directory(study);
  expect_discreet("has no DICOM files");
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
  expect_discreet("has no CT series");
  fill(std::vector<DicomSlice>(fresh.begin() + 1, fresh.end()));
  const std::string whole = test::bytes_of(study / "DOE_3.dcm");
  test::write_bytes(study / "DOE_3.dcm", whole.substr(0, whole.size() - 20));
  expect_discreet("file 4");
  slices = fresh;
  for (DicomSlice& slice : slices) slice.instance_number = "";
  slices[2].position = "";
  fill(slices);
  expect_discreet("DICOM file 3: the image position is missing");
}

TEST(Dicom, NothingOfThePatientIsInWhatIsMadeOfTheScan) {
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
  ASSERT_TRUE(has(test::bytes_of(folder / "DOE_JANE/slice-000.dcm"), "fell off a horse"));
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
  for (const std::string& secret : secrets) EXPECT_FALSE(has(all, secret)) << secret;
}

TEST(Dicom, ForeignFilesArePassedOverWithAWarning) {
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

TEST(Dicom, TheOnlyCtIsTakenAmongOtherSeries) {
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

TEST(Dicom, DamagedFilesOfOtherSeriesArePassedOver) {
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

  test::write_bytes(folder / "scout.dcm", whole.substr(0, 200));  // Before its series is named.
  const auto unknown = read_dicom_series(folder.path());
  ASSERT_TRUE(unknown) << unknown.error().message;
  EXPECT_EQ(unknown->ct.values, ct.values);
  ASSERT_EQ(unknown->warnings.size(), 1U);
  EXPECT_TRUE(has(unknown->warnings[0], "1 DICOM files cannot be read")) << unknown->warnings[0];
  EXPECT_TRUE(has(unknown->warnings[0], "DICOM file 1: it is truncated")) << unknown->warnings[0];
}

TEST(Dicom, ADamagedFileOfTheSeriesIsAnErrorEvenAtItsEnd) {
  const TemporaryFolder folder;
  write_dicom_series(folder.path(), dicom_slices(sample_scan()));
  const std::string whole = test::bytes_of(folder / "slice-005.dcm");
  test::write_bytes(folder / "slice-005.dcm", whole.substr(0, whole.size() - 20));
  const auto result = read_dicom_series(folder.path());
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::kFileCorrupt);
  EXPECT_TRUE(has(result.error().message, "slice 16 (file 6)")) << result.error().message;
}

TEST(Dicom, AnUnreadableFileIsNamedWhenASliceIsMissing) {
  const TemporaryFolder folder;
  write_dicom_series(folder.path(), dicom_slices(sample_scan()));
  test::write_bytes(folder / "slice-002.dcm", "");
  const auto result = read_dicom_series(folder.path());
  ASSERT_FALSE(result);
  EXPECT_TRUE(has(result.error().message, "1 slices are missing")) << result.error().message;
  EXPECT_TRUE(has(result.error().message, "DICOM file 3: it is truncated"))
      << result.error().message;
}

TEST(Dicom, OfSeveralCtsOneMustBeChosen) {
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
  EXPECT_TRUE(has(either.error().message, "1 = CT, 7 x 5, 6 images; 2 = CT, 7 x 5, 6 images"))
      << either.error().message;
  EXPECT_FALSE(has(either.error().message, "1.2.826"));
  EXPECT_EQ(read_dicom_series(folder / "a", 1)->ct.values, ct.values);
  EXPECT_EQ(read_dicom_series(folder / "a", 2)->ct.values[1], -993);
  for (const int series : {-1, 3})
    EXPECT_EQ(read_dicom_series(folder / "a", series).error().code, ErrorCode::kInvalidArgument);
}

TEST(Dicom, AFolderWithoutCtOrWithoutDicomSaysSo) {
  const TemporaryFolder folder;
  EXPECT_TRUE(has(read_dicom_series(folder.path()).error().message, "no DICOM files"));
  auto slices = dicom_slices(sample_scan());
  for (DicomSlice& slice : slices) slice.modality = "MR";
  EXPECT_TRUE(has(complaint(slices, ErrorCode::kFileUnsupported), "1 = MR"));
  for (DicomSlice& slice : slices) slice.modality = "JANE DOE";
  EXPECT_TRUE(has(complaint(slices, ErrorCode::kFileUnsupported), "1 = unknown"));
  EXPECT_EQ(read_dicom_series(folder / "none").error().code, ErrorCode::kFileNotFound);
}

TEST(Dicom, AMissingSliceIsNoticedAndPlaced) {
  auto slices = dicom_slices(sample_scan());
  slices.erase(slices.begin() + 3);
  const std::string message = complaint(slices, ErrorCode::kFileCorrupt);
  EXPECT_TRUE(has(message, "1 slices are missing between slice 13 (file 3) and slice 15 (file 4)"))
      << message;
  EXPECT_TRUE(has(message, "2.5 mm")) << message;
}

TEST(Dicom, UnevenSlicesAreRefusedAndSlightlyUnevenOnesNamed) {
  auto slices = dicom_slices(sample_scan());
  slices[3].position = "-80.5\\-31.25\\16.0";  // 15.75 would be even, 1.25 mm apart.
  EXPECT_TRUE(has(complaint(slices, ErrorCode::kFileCorrupt), "1 to 1.5 mm"));

  const TemporaryFolder folder;
  slices[3].position = "-80.5\\-31.25\\15.79";
  write_dicom_series(folder.path(), slices);
  const auto found = read_dicom_series(folder.path());
  ASSERT_TRUE(found) << found.error().message;
  // Least squares: slice 3 of 0 ... 5 is 0.04 mm too high, half a slice beyond the middle.
  const double slope_mm = 1.25 + 0.5 * 0.04 / 17.5;
  EXPECT_NEAR(found->ct.grid.spacing_mm.z(), slope_mm, 1e-9);
  EXPECT_NEAR(found->ct.grid.origin_L.z(), 12.0 + 2.5 * 1.25 + 0.04 / 6.0 - 2.5 * slope_mm, 1e-9);
  ASSERT_EQ(found->warnings.size(), 1U);
  EXPECT_TRUE(has(found->warnings[0], "1.21 to 1.29 mm")) << found->warnings[0];
}

TEST(Dicom, SmallErrorsOfTheDistanceMayNotAddUp) {
  auto ct = sample_scan();
  ct.grid.size[2] = 60;
  ct.values.resize(7 * 5 * 60);
  auto slices = dicom_slices(ct);
  // Every step is within 4 % of the others, but the middle would lie 0.3 mm from its place.
  for (std::size_t k = 0; k < slices.size(); ++k)
    slices[k].position = fmt::format(
        "-80.5\\-31.25\\{}", 12.0 + 1.25 * double(k) + (k > 30 ? 0.05 * double(k - 30) : 0.0));
  const std::string message = complaint(slices, ErrorCode::kFileCorrupt);
  EXPECT_TRUE(has(message, "from its position in an even stack")) << message;
}

TEST(Dicom, AnInnerSliceBesideTheStackIsNamed) {
  auto slices = dicom_slices(sample_scan());
  slices[3].position = "-80.27\\-31.25\\15.75";  // 0.23 mm to the left; a pixel is 0.4 mm.
  const std::string message = complaint(slices, ErrorCode::kFileCorrupt);
  EXPECT_TRUE(has(message, "slice 14 (file 4) is displaced sideways by 0.23 mm")) << message;
  slices[2].position = "-50.5\\-31.25\\14.5";
  slices[3].position = "-50.5\\-31.25\\15.75";
  EXPECT_TRUE(has(complaint(slices, ErrorCode::kFileCorrupt), "sideways by 30 mm"));

  slices = dicom_slices(sample_scan());
  slices[3].position = "-80.4\\-31.25\\15.75";  // A quarter of a pixel.
  const TemporaryFolder folder;
  write_dicom_series(folder.path(), slices);
  EXPECT_TRUE(read_dicom_series(folder.path()));
}

TEST(Dicom, CopiesAreLeftOutButTwoSlicesAtOnePlaceAreRefused) {
  const auto ct = sample_scan();
  auto slices = dicom_slices(ct);
  slices.push_back(slices[2]);
  const TemporaryFolder folder;
  write_dicom_series(folder.path(), slices);
  const auto found = read_dicom_series(folder.path());
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->ct.values, ct.values);
  EXPECT_EQ(found->warnings, std::vector<std::string>{"1 copies of slices were omitted"});

  slices.back().instance_uid += ".9";
  EXPECT_TRUE(has(complaint(slices, ErrorCode::kFileCorrupt), "the same position"));
}

TEST(Dicom, SlicesThatDoNotFitTogetherAreNamed) {
  const auto fresh = dicom_slices(sample_scan());
  auto slices = fresh;
  slices[4].rows = 4;
  EXPECT_TRUE(has(complaint(slices, ErrorCode::kFileCorrupt), "size, 7 x 5 and 7 x 4"));
  slices = fresh;
  slices[4].orientation = "1\\0\\0\\0\\0\\-1";
  EXPECT_TRUE(has(complaint(slices, ErrorCode::kFileCorrupt), "orientation"));
  slices = fresh;
  slices[4].pixel_spacing = "0.5\\0.41";
  const std::string message = complaint(slices, ErrorCode::kFileCorrupt);
  EXPECT_TRUE(has(message, "pixel spacing: slice 11 (file 1) and slice 15 (file 5)")) << message;
}

TEST(Dicom, AFileWithoutAPlaceIsNamed) {
  const auto fresh = dicom_slices(sample_scan());
  const auto broken = [&](const auto& change) {
    auto slices = fresh;
    change(slices[2]);
    return slices;
  };
  const auto unsupported = ErrorCode::kFileUnsupported;
  EXPECT_TRUE(has(complaint(broken([](auto& s) { s.position = ""; }), unsupported),
                  "DICOM slice 13 (file 3): the image position"));
  EXPECT_TRUE(
      has(complaint(broken([](auto& s) { s.position = "1\\2\\x"; }), unsupported), "position"));
  EXPECT_TRUE(
      has(complaint(broken([](auto& s) { s.orientation = ""; }), unsupported), "orientation"));
  EXPECT_TRUE(
      has(complaint(broken([](auto& s) { s.pixel_spacing = "0.5"; }), unsupported), "spacing"));
  EXPECT_TRUE(has(complaint(broken([](auto& s) { s.frames = "12"; }), unsupported), "12 frames"));
  EXPECT_TRUE(has(complaint(broken([](auto& s) { s.samples_per_pixel = 3; }), unsupported),
                  "3 values per pixel"));
  EXPECT_TRUE(has(complaint(broken([](auto& s) { s.orientation = "1\\0\\0\\0.5\\1\\0"; }),
                            ErrorCode::kFileCorrupt),
                  "axes deviate"));
  EXPECT_TRUE(
      has(complaint(broken([](auto& s) { s.position = "nan\\0\\0"; }), ErrorCode::kFileCorrupt),
          "slice 13"));
}

TEST(Dicom, GridsThatCannotBeAreRefused) {
  for (const char* const spacing : {"0\\0.4", "-0.5\\0.4", "nan\\nan", "1e9\\1e9"}) {
    auto slices = dicom_slices(sample_scan());
    for (DicomSlice& slice : slices) slice.pixel_spacing = spacing;
    complaint(slices, ErrorCode::kFileCorrupt);
  }
}

/// The sample scan with every slice `slide_mm` further to posterior than the one below.
std::vector<DicomSlice> sheared(double slide_mm) {
  auto slices = dicom_slices(sample_scan());
  for (std::size_t k = 0; k < slices.size(); ++k)
    slices[k].position =
        fmt::format("-80.5\\{}\\{}", -31.25 + slide_mm * double(k), 12.0 + 1.25 * double(k));
  return slices;
}

TEST(Dicom, ATiltedGantryIsResampledStraightWithItsAngle) {
  const TemporaryFolder folder;
  const auto ct = sample_scan();
  write_dicom_series(folder.path(), sheared(0.5));  // A pixel: what is resampled stays exact.
  const auto found = read_dicom_series(folder.path());
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->ct.grid.size, (std::array<Index, 3>{7, 5 + 5, 6}));
  EXPECT_EQ(found->ct.grid.origin_L, ct.grid.origin_L);
  const std::int16_t outside = *std::min_element(ct.values.begin(), ct.values.end());
  for (Index k = 0; k < 6; ++k)
    for (Index j = 0; j < 10; ++j)
      for (Index i = 0; i < 7; ++i)
        EXPECT_EQ(found->ct.at(i, j, k), j >= k && j < k + 5 ? ct.at(i, j - k, k) : outside)
            << i << ' ' << j << ' ' << k;
  ASSERT_GE(found->warnings.size(), 1U);
  EXPECT_TRUE(has(found->warnings[0], "sheared by 21.8 degrees")) << found->warnings[0];
  EXPECT_TRUE(has(found->warnings[0], "resampled"));
  ASSERT_TRUE(found->stack);
  EXPECT_NEAR(found->stack->tilt_deg, 21.801, 1e-3);
  EXPECT_TRUE(found->stack->resampled);
}

TEST(Dicom, WhatIsShearedByMoreThanAGantryTiltsIsRefused) {
  EXPECT_TRUE(has(complaint(sheared(1.3), ErrorCode::kFileUnsupported), "46.1 degrees"));
}

/// The sample scan with its slices at these heights [mm].
std::vector<DicomSlice> at_heights(const std::vector<double>& heights_mm) {
  auto slices = dicom_slices(sample_scan());
  slices.resize(heights_mm.size(), slices.back());
  for (std::size_t k = 0; k < slices.size(); ++k) {
    slices[k].instance_uid += fmt::format(".{}", k);
    slices[k].instance_number = fmt::format("{}", k + 1);
    slices[k].position = fmt::format("-80.5\\-31.25\\{}", heights_mm[k]);
    for (std::int16_t& value : slices[k].stored)
      value = static_cast<std::int16_t>(1024 + 100.0 * heights_mm[k]);
  }
  return slices;
}

TEST(Dicom, RunsOfSeveralDistancesAreResampled) {
  const TemporaryFolder folder;
  write_dicom_series(folder.path(), at_heights({0, 2.5, 5, 7.5, 8.5, 9.5, 10.5, 11.5}));
  const auto found = read_dicom_series(folder.path());
  ASSERT_TRUE(found) << found.error().message;
  // 11.5 mm in 12 steps, the most that are no finer than the finest.
  ASSERT_EQ(found->ct.grid.size[2], 13);
  EXPECT_NEAR(found->ct.grid.spacing_mm.z(), 11.5 / 12.0, 1e-12);
  for (Index k = 0; k < 13; ++k)
    EXPECT_NEAR(found->ct.at(3, 2, k), 100.0 * 11.5 / 12.0 * double(k), 0.51);
  EXPECT_TRUE(has(found->warnings.at(0), "1 to 2.5 mm; they are resampled"));
  EXPECT_EQ(found->stack->min_step_mm, 1.0);
  EXPECT_EQ(found->stack->max_step_mm, 2.5);
}

TEST(Dicom, RunsThatAreTooShortTooWideOrWithoutTheirSlicesAreRefused) {
  EXPECT_TRUE(
      has(complaint(at_heights({0, 1, 2, 3, 4, 6.5, 9}), ErrorCode::kFileCorrupt), "1 to 2.5 mm"));
  EXPECT_TRUE(has(complaint(at_heights({0, 1, 2, 3, 9, 15, 21}), ErrorCode::kFileUnsupported),
                  "at most 5 mm"));
  auto slices = at_heights({0, 1, 2, 3, 5, 7, 9});
  for (std::size_t k = 4; k < 7; ++k)
    slices[k].instance_number = fmt::format("{}", 4 + 2 * (k - 3));  // 6, 8, 10.
  EXPECT_TRUE(has(complaint(slices, ErrorCode::kFileCorrupt), "1 to 2 mm"));
}

TEST(Dicom, AScanOfWhichMuchCannotBeReadIsRefused) {
  const TemporaryFolder folder;
  write_dicom_series(folder.path(), dicom_slices(sample_scan()));
  for (const char* const name : {"slice-003.dcm", "slice-004.dcm", "slice-005.dcm"})
    test::write_bytes(folder / name, "");
  const auto half = read_dicom_series(folder.path());
  ASSERT_FALSE(half);
  EXPECT_EQ(half.error().code, ErrorCode::kFileCorrupt);
  EXPECT_TRUE(has(half.error().message, "3 DICOM files cannot be read in addition to 3 slices"))
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
  const DicomSeriesInfo& first = (*list)[1];  // In the order of their identifiers.
  EXPECT_EQ(first.number, 2);
  EXPECT_EQ(first.modality, "CT");
  EXPECT_EQ(first.images, 6);
  EXPECT_EQ(first.columns, 7);
  EXPECT_EQ(first.rows, 5);
  EXPECT_EQ(first.kernel, "H60s");
  EXPECT_EQ(first.pixel_mm, (std::array{0.4, 0.5}));
  EXPECT_NEAR(first.step_mm.value(), 1.25, 1e-6);
  EXPECT_TRUE(first.is_usable && first.warnings.empty());
  EXPECT_EQ((*list)[0].problem, "no CT");
  EXPECT_FALSE((*list)[0].is_usable);
  EXPECT_EQ((*list)[2].kernel, "");
  EXPECT_TRUE((*list)[2].is_usable);
  EXPECT_TRUE(has((*list)[2].warnings.at(0), "sheared"));
  EXPECT_TRUE(has((*list)[3].problem, "missing"));
  // What is listed under a number is read under it.
  EXPECT_TRUE(read_dicom_series(folder.path(), 3));
  EXPECT_TRUE(has(read_dicom_series(folder.path(), 4).error().message, "missing"));
  EXPECT_FALSE(list_dicom_series(folder / "none"));
}

TEST(Dicom, AReportedTiltThatTheSlicesDoNotShowIsAWarning) {
  const TemporaryFolder folder;
  auto slices = dicom_slices(sample_scan());
  for (DicomSlice& slice : slices) slice.gantry_tilt = "-7.5";
  write_dicom_series(folder.path(), slices);
  const auto found = read_dicom_series(folder.path());
  ASSERT_TRUE(found) << found.error().message;
  ASSERT_EQ(found->warnings.size(), 1U);
  EXPECT_TRUE(has(found->warnings[0], "-7.5 degrees"));
}

TEST(Dicom, AMissingInterceptIsAWarning) {
  const TemporaryFolder folder;
  auto slices = dicom_slices(sample_scan());
  for (DicomSlice& slice : slices) slice.intercept = "";
  write_dicom_series(folder.path(), slices);
  const auto found = read_dicom_series(folder.path());
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->ct.values[0], 24);
  EXPECT_TRUE(has(found->warnings.at(0), "no rescale intercept"));
  EXPECT_TRUE(has(found->warnings.at(1), "may not be in HU"));
}

TEST(Dicom, AMissingSlopeIsAWarning) {
  const TemporaryFolder folder;
  const auto ct = sample_scan();
  auto slices = dicom_slices(ct);
  for (DicomSlice& slice : slices) slice.slope = "";
  write_dicom_series(folder.path(), slices);
  const auto found = read_dicom_series(folder.path());
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->ct.values, ct.values);
  EXPECT_EQ(found->warnings,
            std::vector<std::string>{"the files have no rescale slope, 1 was used"});
}

TEST(Dicom, ASliceOnAnotherScaleThanItsNeighborsIsRefused) {
  const auto fresh = dicom_slices(sample_scan());
  auto slices = fresh;
  slices[3].intercept = "";
  EXPECT_TRUE(
      has(complaint(slices, ErrorCode::kFileCorrupt), "5 of 6 slices have a rescale inter"));
  slices = fresh;
  for (std::size_t k = 1; k < 6; ++k) slices[k].slope = "";
  EXPECT_TRUE(
      has(complaint(slices, ErrorCode::kFileCorrupt), "1 of 6 slices have a rescale slope"));
  for (const char* const slope : {"0", "nan", "inf"}) {
    slices = fresh;
    slices[3].slope = slope;
    EXPECT_TRUE(has(complaint(slices, ErrorCode::kFileCorrupt), "rescaled by")) << slope;
  }
}

TEST(Dicom, ATruncatedFileIsNamedAtWhateverLength) {
  for (const bool compressed : {false, true}) {
    const TemporaryFolder folder;
    const auto ct = sample_scan();
    write_dicom_series(folder.path(), dicom_slices(ct));
    const auto victim = folder / "slice-004.dcm";
    if (compressed) test::compress_dicom(victim);
    const std::string whole = test::bytes_of(victim);
    ::testing::internal::CaptureStderr();
    for (std::size_t length = 0; length < whole.size(); length += 1 + length / 40) {
      test::write_bytes(victim, whole.substr(0, length));
      const auto result = read_dicom_series(folder.path());
      // The last bytes of a JPEG stream are padding; without them the scan is whole.
      if (result && compressed && result->ct.values == ct.values) continue;
      ASSERT_FALSE(result) << length << " of " << whole.size();
      test::expect_one_sentence(result.error().message);
      EXPECT_TRUE(has(result.error().message, "file 5") ||
                  has(result.error().message, "1 slices are missing"))
          << length << ": " << result.error().message;
    }
    EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  }
}

class StopsAtOnce : public Progress {
 public:
  [[nodiscard]] bool stop_requested() const override { return true; }
};

TEST(Dicom, StopsWhenAsked) {
  const TemporaryFolder folder;
  write_dicom_series(folder.path(), dicom_slices(sample_scan()));
  StopsAtOnce progress;
  EXPECT_EQ(read_dicom_series(folder.path(), 0, progress).error().code, ErrorCode::kCancelled);
}

/// A compressed slice, or what looks like one.
class DicomCodec : public ::testing::Test {
 protected:
  void SetUp() override {
    write_dicom(file_, dicom_slices(sample_scan())[2]);
    test::compress_dicom(file_);
  }
  [[nodiscard]] std::string complaint(const CodecLimits& limits, ErrorCode code,
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

TEST_F(DicomCodec, EndsACodecThatNeedsTooMuchMemory) {
  DicomSlice large = dicom_slices(sample_scan())[2];
  // So large that malloc maps it anew, whatever earlier tests have left free.
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

TEST_F(DicomCodec, EndsACodecThatHangs) {
  std::filesystem::remove(file_);
  ASSERT_EQ(::mkfifo(file_.c_str(), 0600), 0);  // Nobody writes: it never gives a byte.
  EXPECT_TRUE(has(complaint({.time = std::chrono::milliseconds(50)}, ErrorCode::kFileCorrupt),
                  "longer than 50 ms"));
  StopsAtOnce progress;
  EXPECT_TRUE(has(complaint({}, ErrorCode::kCancelled, progress), "stopped"));
}

}  // namespace
}  // namespace lefort::io
