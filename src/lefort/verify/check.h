/// \file
/// Checks, tables and sections of a verification report.
#pragma once

#include <lefort/report/plot_lines.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace lefort::verify {

/// How a measured number is compared with the expected one.
enum class Comparison { kNear, kAtLeast, kAtMost };

/// An acceptance criterion and its measured number.
struct Check {
  std::string name;
  double measured = NAN;  ///< NaN if it could not be measured: failed.
  Comparison comparison = Comparison::kNear;
  double expected = 0.0;
  double tolerance = 0.0;   ///< >= 0, in `unit`: accepted difference from `expected`.
  std::string unit = "";    ///< Empty for ratios, orders and counts.
  std::string reason = "";  ///< Source of the tolerance.
  std::string note = "";    ///< Why it could not be measured.
  /// Reason of a known failure, which is reported as missed. Empty: the check must pass.
  std::string known_failure = "";

  [[nodiscard]] bool passed() const {
    switch (comparison) {
      case Comparison::kNear:
        return std::abs(measured - expected) <= tolerance;
      case Comparison::kAtLeast:
        return measured >= expected - tolerance;
      case Comparison::kAtMost:
        return measured <= expected + tolerance;
    }
    return false;
  }

  /// Passed, or a known failure.
  [[nodiscard]] bool is_acceptable() const { return passed() || !known_failure.empty(); }
};

/// Cells are formatted texts.
struct Table {
  std::string title;
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows = {};  ///< As many cells as the header.
};

/// Results of one case.
struct Section {
  std::string name;  ///< As on the command line: lower case and hyphens.
  std::string title;
  std::string text;  ///< Problem, reference solution and its source.
  std::vector<Table> tables = {};
  std::vector<report::LinePlot> plots = {};
  std::vector<Check> checks = {};

  [[nodiscard]] bool passed() const {
    for (const Check& check : checks)
      if (!check.is_acceptable()) return false;
    return !checks.empty();
  }
};

/// A failed check without a measurement, because there was no solution.
[[nodiscard]] inline Check not_measured(std::string name, std::string why) {
  Check check;
  check.name = std::move(name);
  check.note = std::move(why);
  return check;
}

}  // namespace lefort::verify
