/// \file
/// What the suite found, as Markdown with SVG plots.
#pragma once

#include <lefort/verify/check.h>

#include <span>
#include <string>
#include <vector>

namespace lefort::verify {

struct ReportFile {
  std::string name;  ///< In the folder of the report.
  std::string content;
};

/// \param command  that made it: told at its head.
/// \returns verification.md and one verification-CASE-NUMBER.svg per plot. No clock, no machine:
///   the same measurements give the same files.
[[nodiscard]] std::vector<ReportFile> verification_report(std::span<const Section> sections,
                                                          const std::string& command);

/// "0.0123 <= 0.02 mm": what was found and what was asked.
[[nodiscard]] std::string text_of(const Check& check);

}  // namespace lefort::verify
