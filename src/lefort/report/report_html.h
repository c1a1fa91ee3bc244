/// \file
/// The report as one self-contained page.
#pragma once

#include <lefort/report/case_report.h>

#include <string>

namespace lefort::report {

/// \param report  the content. Every text is escaped; bytes that are not UTF-8 become U+FFFD.
/// \returns an HTML page for light screens, dark screens and paper, which is also well-formed XML.
///   Styles, plots and pictures are inline; a content security policy forbids loading anything
///   else.
[[nodiscard]] std::string report_html(const CaseReport& report);

}  // namespace lefort::report
