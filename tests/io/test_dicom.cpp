#include <lefort/io/dicom.h>
#include <lefort/io/internal/dicom_codec.h>

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

TEST(Dicom, ReadsLosslessJpeg) {
  const TemporaryFolder folder;
  const auto ct = sample_scan();
  write_dicom_series(folder.path(), dicom_slices(ct));
  for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
    test::compress_dicom(entry.path());
  const auto found = read_dicom_series(folder.path());
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->ct.values, ct.values);
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
  expect_discreet("holds no DICOM files");
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
  expect_discreet("holds no CT series");
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

TEST(Dicom, ForeignFilesArePassedOverWithAWarning) {
  const TemporaryFolder folder;
  write_dicom_series(folder.path(), dicom_slices(sample_scan()));
  test::write_bytes(folder / "README.txt", "JANE DOE");
  test::write_bytes(folder / "empty", "");
  std::filesystem::create_directory(folder / "DOE");
  const auto found = read_dicom_series(folder.path());
  ASSERT_TRUE(found) << found.error().message;
  ASSERT_EQ(found->warnings.size(), 1U);
  EXPECT_EQ(found->warnings[0], "2 files are no DICOM images and were passed over");
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
  EXPECT_EQ(found->warnings, std::vector<std::string>{"2 other series were passed over"});
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
  EXPECT_EQ(known->warnings, (std::vector<std::string>{"1 other series were passed over",
                                                       "1 files of them are damaged"}));

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
  EXPECT_TRUE(has(complaint(slices, ErrorCode::kFileCorrupt), "1 to 1.5 mm apart"));

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
  EXPECT_TRUE(has(message, "from its place in an even stack")) << message;
}

TEST(Dicom, AnInnerSliceBesideTheStackIsNamed) {
  auto slices = dicom_slices(sample_scan());
  slices[3].position = "-80.27\\-31.25\\15.75";  // 0.23 mm to the left; a pixel is 0.4 mm.
  const std::string message = complaint(slices, ErrorCode::kFileCorrupt);
  EXPECT_TRUE(has(message, "slice 14 (file 4) lies 0.23 mm beside")) << message;
  slices[2].position = "-50.5\\-31.25\\14.5";
  slices[3].position = "-50.5\\-31.25\\15.75";
  EXPECT_TRUE(has(complaint(slices, ErrorCode::kFileCorrupt), "30 mm beside"));

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
  EXPECT_EQ(found->warnings, std::vector<std::string>{"1 copies of slices were left out"});

  slices.back().instance_uid += ".9";
  EXPECT_TRUE(has(complaint(slices, ErrorCode::kFileCorrupt), "at the same place"));
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

TEST(Dicom, ATiltedGantryIsRefusedWithItsAngle) {
  auto ct = sample_scan();
  auto slices = dicom_slices(ct);
  for (std::size_t k = 0; k < slices.size(); ++k)  // 12 degrees: tan = 0.2126
    slices[k].position =
        fmt::format("-80.5\\{}\\{}", -31.25 + 0.2126 * 1.25 * double(k), 12.0 + 1.25 * double(k));
  EXPECT_TRUE(has(complaint(slices, ErrorCode::kFileUnsupported), "12.0 degrees"));
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
            std::vector<std::string>{"the files give no rescale slope, 1 was taken"});
}

TEST(Dicom, ASliceOnAnotherScaleThanItsNeighboursIsRefused) {
  const auto fresh = dicom_slices(sample_scan());
  auto slices = fresh;
  slices[3].intercept = "";
  EXPECT_TRUE(
      has(complaint(slices, ErrorCode::kFileCorrupt), "5 of 6 slices give a rescale inter"));
  slices = fresh;
  for (std::size_t k = 1; k < 6; ++k) slices[k].slope = "";
  EXPECT_TRUE(
      has(complaint(slices, ErrorCode::kFileCorrupt), "1 of 6 slices give a rescale slope"));
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
  large.columns = large.rows = 1024;
  large.stored.assign(1024 * 1024, 7);
  write_dicom(file_, large);
  test::compress_dicom(file_);
  ASSERT_TRUE(decode_dicom_pixels(file_, 1024 * 1024));
  const auto result =
      decode_dicom_pixels(file_, 1024 * 1024, Progress::none(), {.memory_bytes = 1 << 20});
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
