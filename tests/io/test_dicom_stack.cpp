#include <lefort/io/dicom.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "io/dicom_series.h"
#include "io/dicom_writer.h"
#include "io/sample_scan.h"
#include "support/temporary_folder.h"
#include "support/text.h"

namespace lefort::io::test_dicom_stack {
namespace {

using test::contains;
using test::dicom_slices;
using test::DicomSlice;
using test::sample_scan;
using test::series_error;
using test::sheared;
using test::TemporaryFolder;
using test::write_dicom_series;

TEST(Dicom, ReportsTheLocationOfAMissingSlice) {
  auto slices = dicom_slices(sample_scan());
  slices.erase(slices.begin() + 3);
  const std::string message = series_error(slices, ErrorCode::kFileCorrupt);
  EXPECT_TRUE(
      contains(message, "1 slices are missing between slice 13 (file 3) and slice 15 (file 4)"))
      << message;
  EXPECT_TRUE(contains(message, "2.5 mm")) << message;
}

TEST(Dicom, RejectsUnevenSlicesAndWarnsOfSlightlyUnevenOnes) {
  auto slices = dicom_slices(sample_scan());
  slices[3].position = "-80.5\\-31.25\\16.0";  // 15.75 would be even, 1.25 mm apart.
  EXPECT_TRUE(contains(series_error(slices, ErrorCode::kFileCorrupt), "1 to 1.5 mm"));

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
  EXPECT_TRUE(contains(found->warnings[0], "1.21 to 1.29 mm")) << found->warnings[0];
}

TEST(Dicom, RejectsAccumulatedDistanceErrors) {
  auto ct = sample_scan();
  ct.grid.size[2] = 60;
  ct.values.resize(7 * 5 * 60);
  auto slices = dicom_slices(ct);
  // Every step is within 4 % of the others, but the middle slice is 0.3 mm from its even position.
  for (std::size_t k = 0; k < slices.size(); ++k)
    slices[k].position = fmt::format(
        "-80.5\\-31.25\\{}", 12.0 + 1.25 * double(k) + (k > 30 ? 0.05 * double(k - 30) : 0.0));
  const std::string message = series_error(slices, ErrorCode::kFileCorrupt);
  EXPECT_TRUE(contains(message, "from its position in an even stack")) << message;
}

TEST(Dicom, NamesASliceThatIsDisplacedSideways) {
  auto slices = dicom_slices(sample_scan());
  slices[3].position = "-80.27\\-31.25\\15.75";  // 0.23 mm to the left; a pixel is 0.4 mm.
  const std::string message = series_error(slices, ErrorCode::kFileCorrupt);
  EXPECT_TRUE(contains(message, "slice 14 (file 4) is displaced sideways by 0.23 mm")) << message;
  slices[2].position = "-50.5\\-31.25\\14.5";
  slices[3].position = "-50.5\\-31.25\\15.75";
  EXPECT_TRUE(contains(series_error(slices, ErrorCode::kFileCorrupt), "sideways by 30 mm"));

  slices = dicom_slices(sample_scan());
  slices[3].position = "-80.4\\-31.25\\15.75";  // A quarter of a pixel.
  const TemporaryFolder folder;
  write_dicom_series(folder.path(), slices);
  EXPECT_TRUE(read_dicom_series(folder.path()));
}

TEST(Dicom, OmitsCopiesButRejectsTwoSlicesAtOnePosition) {
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
  EXPECT_TRUE(contains(series_error(slices, ErrorCode::kFileCorrupt), "the same position"));
}

TEST(Dicom, NamesIncompatibleSlices) {
  const auto fresh = dicom_slices(sample_scan());
  auto slices = fresh;
  slices[4].rows = 4;
  EXPECT_TRUE(contains(series_error(slices, ErrorCode::kFileCorrupt), "size, 7 x 5 and 7 x 4"));
  slices = fresh;
  slices[4].orientation = "1\\0\\0\\0\\0\\-1";
  EXPECT_TRUE(contains(series_error(slices, ErrorCode::kFileCorrupt), "orientation"));
  slices = fresh;
  slices[4].pixel_spacing = "0.5\\0.41";
  const std::string message = series_error(slices, ErrorCode::kFileCorrupt);
  EXPECT_TRUE(contains(message, "pixel spacing: slice 11 (file 1) and slice 15 (file 5)"))
      << message;
}

TEST(Dicom, NamesAFileWithoutPosition) {
  const auto fresh = dicom_slices(sample_scan());
  const auto broken = [&](const auto& change) {
    auto slices = fresh;
    change(slices[2]);
    return slices;
  };
  const auto unsupported = ErrorCode::kFileUnsupported;
  EXPECT_TRUE(contains(series_error(broken([](auto& s) { s.position = ""; }), unsupported),
                       "DICOM slice 13 (file 3): the image position"));
  EXPECT_TRUE(contains(series_error(broken([](auto& s) { s.position = "1\\2\\x"; }), unsupported),
                       "position"));
  EXPECT_TRUE(contains(series_error(broken([](auto& s) { s.orientation = ""; }), unsupported),
                       "orientation"));
  EXPECT_TRUE(contains(series_error(broken([](auto& s) { s.pixel_spacing = "0.5"; }), unsupported),
                       "spacing"));
  EXPECT_TRUE(
      contains(series_error(broken([](auto& s) { s.frames = "12"; }), unsupported), "12 frames"));
  EXPECT_TRUE(contains(series_error(broken([](auto& s) { s.samples_per_pixel = 3; }), unsupported),
                       "3 values per pixel"));
  EXPECT_TRUE(contains(series_error(broken([](auto& s) { s.orientation = "1\\0\\0\\0.5\\1\\0"; }),
                                    ErrorCode::kFileCorrupt),
                       "axes deviate"));
  EXPECT_TRUE(contains(
      series_error(broken([](auto& s) { s.position = "nan\\0\\0"; }), ErrorCode::kFileCorrupt),
      "slice 13"));
}

TEST(Dicom, RejectsInvalidGrids) {
  for (const char* const spacing : {"0\\0.4", "-0.5\\0.4", "nan\\nan", "1e9\\1e9"}) {
    auto slices = dicom_slices(sample_scan());
    for (DicomSlice& slice : slices) slice.pixel_spacing = spacing;
    series_error(slices, ErrorCode::kFileCorrupt);
  }
}

TEST(Dicom, ResamplesGantryTiltAndReportsItsAngle) {
  const TemporaryFolder folder;
  const auto ct = sample_scan();
  write_dicom_series(folder.path(), sheared(0.5));  // One pixel, so that resampling is exact.
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
  EXPECT_TRUE(contains(found->warnings[0], "sheared by 21.8 degrees")) << found->warnings[0];
  EXPECT_TRUE(contains(found->warnings[0], "resampled"));
  ASSERT_TRUE(found->stack);
  EXPECT_NEAR(found->stack->tilt_deg, 21.801, 1e-3);
  EXPECT_TRUE(found->stack->resampled);
}

TEST(Dicom, RejectsLargerShearThanGantryTilt) {
  EXPECT_TRUE(contains(series_error(sheared(1.3), ErrorCode::kFileUnsupported), "46.1 degrees"));
}

/// Returns the sample scan with slices at these heights [mm].
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

TEST(Dicom, ResamplesRunsOfSeveralDistances) {
  const TemporaryFolder folder;
  write_dicom_series(folder.path(), at_heights({0, 2.5, 5, 7.5, 8.5, 9.5, 10.5, 11.5}));
  const auto found = read_dicom_series(folder.path());
  ASSERT_TRUE(found) << found.error().message;
  // 11.5 mm in 12 steps.
  ASSERT_EQ(found->ct.grid.size[2], 13);
  EXPECT_NEAR(found->ct.grid.spacing_mm.z(), 11.5 / 12.0, 1e-12);
  for (Index k = 0; k < 13; ++k)
    EXPECT_NEAR(found->ct.at(3, 2, k), 100.0 * 11.5 / 12.0 * double(k), 0.51);
  EXPECT_TRUE(contains(found->warnings.at(0), "1 to 2.5 mm; they are resampled"));
  EXPECT_EQ(found->stack->min_step_mm, 1.0);
  EXPECT_EQ(found->stack->max_step_mm, 2.5);
}

TEST(Dicom, RejectsRunsThatAreTooShortTooWideOrIncomplete) {
  EXPECT_TRUE(contains(series_error(at_heights({0, 1, 2, 3, 4, 6.5, 9}), ErrorCode::kFileCorrupt),
                       "1 to 2.5 mm"));
  EXPECT_TRUE(
      contains(series_error(at_heights({0, 1, 2, 3, 9, 15, 21}), ErrorCode::kFileUnsupported),
               "at most 5 mm"));
  auto slices = at_heights({0, 1, 2, 3, 5, 7, 9});
  for (std::size_t k = 4; k < 7; ++k)
    slices[k].instance_number = fmt::format("{}", 4 + 2 * (k - 3));  // 6, 8, 10.
  EXPECT_TRUE(contains(series_error(slices, ErrorCode::kFileCorrupt), "1 to 2 mm"));
}

TEST(Dicom, WarnsIfTheReportedTiltContradictsTheSlices) {
  const TemporaryFolder folder;
  auto slices = dicom_slices(sample_scan());
  for (DicomSlice& slice : slices) slice.gantry_tilt = "-7.5";
  write_dicom_series(folder.path(), slices);
  const auto found = read_dicom_series(folder.path());
  ASSERT_TRUE(found) << found.error().message;
  ASSERT_EQ(found->warnings.size(), 1U);
  EXPECT_TRUE(contains(found->warnings[0], "-7.5 degrees"));
}

TEST(Dicom, WarnsOfAMissingIntercept) {
  const TemporaryFolder folder;
  auto slices = dicom_slices(sample_scan());
  for (DicomSlice& slice : slices) slice.intercept = "";
  write_dicom_series(folder.path(), slices);
  const auto found = read_dicom_series(folder.path());
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->ct.values[0], 24);
  EXPECT_TRUE(contains(found->warnings.at(0), "no rescale intercept"));
  EXPECT_TRUE(contains(found->warnings.at(1), "may not be in HU"));
}

TEST(Dicom, WarnsOfAMissingSlope) {
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

TEST(Dicom, RejectsASliceWithAnotherScale) {
  const auto fresh = dicom_slices(sample_scan());
  auto slices = fresh;
  slices[3].intercept = "";
  EXPECT_TRUE(contains(series_error(slices, ErrorCode::kFileCorrupt),
                       "5 of 6 slices have a rescale inter"));
  slices = fresh;
  for (std::size_t k = 1; k < 6; ++k) slices[k].slope = "";
  EXPECT_TRUE(contains(series_error(slices, ErrorCode::kFileCorrupt),
                       "1 of 6 slices have a rescale slope"));
  for (const char* const slope : {"0", "nan", "inf"}) {
    slices = fresh;
    slices[3].slope = slope;
    EXPECT_TRUE(contains(series_error(slices, ErrorCode::kFileCorrupt), "rescaled by")) << slope;
  }
}

}  // namespace
}  // namespace lefort::io::test_dicom_stack
