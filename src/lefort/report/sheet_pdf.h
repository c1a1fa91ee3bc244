/// \file
/// Sheets of paper: pictures and tables as a PDF.
#pragma once

#include <lefort/core/error.h>
#include <lefort/report/case_report.h>

#include <string>
#include <vector>

namespace lefort::report {

/// What is printed, in this order.
struct Sheet {
  std::string title{};
  std::vector<std::string> lines{};       ///< Below the title; long ones are wrapped.
  std::vector<ReportPicture> pictures{};  ///< In rows of `pictures_per_row`.
  int pictures_per_row = 2;               ///< 1 to 4.
  std::vector<ReportTable> tables{};      ///< A long one continues on the next page.
};

/// \param sheet  texts in plain UTF-8.
/// \returns the bytes of a PDF in A4, with kNotForClinicalUse and the page number on each page; or
///   kFileCorrupt if a picture is no PNG; or kInvalidArgument for `pictures_per_row`.
/// \note Equal sheets give equal bytes: the date of creation in the file is always 2000-01-01.
[[nodiscard]] Result<std::string> sheet_pdf(const Sheet& sheet);

}  // namespace lefort::report
