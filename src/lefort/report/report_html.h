/// \file
/// The report as one page that needs nothing but itself.
#pragma once

#include <lefort/report/case_report.h>

#include <string>

namespace lefort::report {

/// \returns a whole HTML page: styles, plots and pictures inline, nothing loaded from elsewhere (a
///   content security policy forbids it), for light, dark and paper. It is also well-formed XML.
///   Every text of `report` is escaped; bytes that are not UTF-8 become U+FFFD.
[[nodiscard]] std::string report_html(const CaseReport& report);

}  // namespace lefort::report
