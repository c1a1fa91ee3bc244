#include <lefort/core/types.h>
#include <lefort/verify/verification_report.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lefort::verify {
namespace {

/// Texts in a table must not end its cells.
std::string cell(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    if (c == '|') safe += '\\';
    safe += c == '\n' ? ' ' : c;
  }
  return safe;
}

std::string line_of(const std::vector<std::string>& cells) {
  std::string line = "|";
  for (const std::string& one : cells) line += fmt::format(" {} |", cell(one));
  return line + "\n";
}

std::string text_of(const Table& table) {
  std::string text = fmt::format("{}:\n\n", table.title) + line_of(table.header);
  text += line_of(std::vector<std::string>(table.header.size(), "---"));
  for (const auto& row : table.rows) text += line_of(row);
  return text + "\n";
}

std::string with_unit(double value, const std::string& unit) {
  return unit.empty() ? fmt::format("{:.4g}", value) : fmt::format("{:.4g} {}", value, unit);
}

std::string required_by(const Check& check) {
  switch (check.comparison) {
    case Comparison::kNear:
      return fmt::format("{} ± {:.2g}", with_unit(check.expected, check.unit), check.tolerance);
    case Comparison::kAtLeast:
      return fmt::format("≥ {}", with_unit(check.expected - check.tolerance, check.unit));
    case Comparison::kAtMost:
      return fmt::format("≤ {}", with_unit(check.expected + check.tolerance, check.unit));
  }
  return "";
}

std::string measured_of(const Check& check) {
  if (std::isnan(check.measured) && !check.note.empty()) return check.note;
  return with_unit(check.measured, check.unit);
}

const char* verdict_on(const Check& check) {
  if (check.passed()) return "passed";
  return check.known_failure.empty() ? "**failed**" : "**missed**";
}

std::string why(const Check& check) {
  if (check.passed() || check.known_failure.empty()) return check.reason;
  return fmt::format("{}. Missed: {}", check.reason, check.known_failure);
}

Index count_missed(const Section& section) {
  return std::count_if(section.checks.begin(), section.checks.end(),
                       [](const Check& check) { return !check.passed() && check.is_acceptable(); });
}

Index count_passed(const Section& section) {
  return std::count_if(section.checks.begin(), section.checks.end(),
                       [](const Check& check) { return check.passed(); });
}

std::string text_of(const Section& section, std::vector<ReportFile>& files) {
  std::string text = fmt::format("## {}\n\n{}\n\n", section.title, section.text);
  for (const Table& table : section.tables) text += text_of(table);
  for (std::size_t k = 0; k < section.plots.size(); ++k) {
    files.push_back({.name = fmt::format("verification-{}-{}.svg", section.name, k + 1),
                     .content = report::plot_file(section.plots[k])});
    text += fmt::format("![{}]({})\n\n", section.plots[k].title, files.back().name);
  }
  text += line_of({"check", "measured", "asked", "because", ""});
  text += line_of({"---", "---", "---", "---", "---"});
  for (const Check& check : section.checks)
    text += line_of({check.name, measured_of(check), check.note.empty() ? required_by(check) : "",
                     why(check), verdict_on(check)});
  return text + "\n";
}

}  // namespace

std::string text_of(const Check& check) {
  return check.note.empty() ? fmt::format("{}, asked {}", measured_of(check), required_by(check))
                            : check.note;
}

std::vector<ReportFile> verification_report(std::span<const Section> sections,
                                            const std::string& command) {
  std::vector<ReportFile> files{{.name = "verification.md", .content = ""}};
  std::string text = fmt::format(
      "# Verification of the finite element solver\n\n"
      "Made by `{}`: tables, plots and verdicts are measured. The texts are written beforehand. "
      "What is asked comes from theory or from the measured order; where that is known not to be "
      "met, the verdict is *missed*. Verification asks whether "
      "the equations are solved right; whether they are the right equations for a face is another "
      "question.\n\n",
      command);
  text += line_of({"case", "checks", "passed", "missed"}) + line_of({"---", "---", "---", "---"});
  for (const Section& section : sections)
    text += line_of({section.title, fmt::format("{}", section.checks.size()),
                     fmt::format("{}", count_passed(section)),
                     fmt::format("{}", count_missed(section))});
  text += "\n";
  for (const Section& section : sections) text += text_of(section, files);
  text.pop_back();
  files.front().content = std::move(text);
  return files;
}

}  // namespace lefort::verify
