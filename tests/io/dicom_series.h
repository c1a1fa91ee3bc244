/// \file
/// DICOM series for tests, and the errors of reading them.
#pragma once

#include <lefort/io/dicom.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "io/dicom_writer.h"
#include "io/sample_scan.h"
#include "support/temporary_folder.h"

namespace lefort::test {

/// Returns the message of the error of reading `slices`, which must have this code.
inline std::string series_error(const std::vector<DicomSlice>& slices, ErrorCode code) {
  const TemporaryFolder folder;
  write_dicom_series(folder / "DOE^JANE", slices);
  const auto result = io::read_dicom_series(folder / "DOE^JANE");
  if (result) {
    ADD_FAILURE() << "no error";
    return "";
  }
  EXPECT_EQ(result.error().code, code) << result.error().message;
  expect_one_sentence(result.error().message);
  EXPECT_EQ(result.error().message.find("DOE"), std::string::npos);
  return result.error().message;
}

/// Returns the sample scan with each slice `slide_mm` posterior to the one below.
inline std::vector<DicomSlice> sheared(double slide_mm) {
  auto slices = dicom_slices(sample_scan());
  for (std::size_t k = 0; k < slices.size(); ++k)
    slices[k].position =
        fmt::format("-80.5\\{}\\{}", -31.25 + slide_mm * double(k), 12.0 + 1.25 * double(k));
  return slices;
}

}  // namespace lefort::test
