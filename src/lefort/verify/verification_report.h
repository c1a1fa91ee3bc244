/// \file
/// Writes the results of the suite as Markdown with SVG plots.
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

/// \param sections  of the cases.
/// \param command   that made the report; stated in its first paragraph.
/// \returns verification.md and one verification-CASE-NUMBER.svg per plot. They contain neither
///   time nor machine: the same measurements give the same files.
[[nodiscard]] std::vector<ReportFile> verification_report(std::span<const Section> sections,
                                                          const std::string& command);

/// Measured value and acceptance criterion: "0.0123 mm, required ≤ 0.02 mm"; or the note, if any.
[[nodiscard]] std::string text_of(const Check& check);

}  // namespace lefort::verify
