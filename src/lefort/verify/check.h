/// \file
/// What a verification measured, what it should have been, and what it tells.
#pragma once

#include <lefort/report/plot_lines.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace lefort::verify {

/// How a measured number is held against the expected one.
enum class Comparison { kNear, kAtLeast, kAtMost };

/// One number that was measured.
struct Check {
  std::string name;
  double measured = NAN;  ///< NaN where there was nothing to measure: failed.
  Comparison comparison = Comparison::kNear;
  double expected = 0.0;
  double tolerance = 0.0;   ///< >= 0, in `unit`; beyond `expected` on the side that is refused.
  std::string unit = "";    ///< Empty for ratios, orders and counts.
  std::string reason = "";  ///< Why this tolerance: one sentence.
  std::string note = "";    ///< Why there was nothing to measure.
  std::string known_failure = "";  ///< Known to fail, and why; told as missed. Empty: must pass.

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

  /// Passed, or known not to.
  [[nodiscard]] bool is_acceptable() const { return passed() || !known_failure.empty(); }
};

/// Cells are texts, as they are to be read.
struct Table {
  std::string title;
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows = {};  ///< As many cells as the header.
};

/// All that one case found.
struct Section {
  std::string name;  ///< As on the command line: small letters and hyphens.
  std::string title;
  std::string text;  ///< What is verified, against what, with its source.
  std::vector<Table> tables = {};
  std::vector<report::LinePlot> plots = {};
  std::vector<Check> checks = {};

  [[nodiscard]] bool passed() const {
    for (const Check& check : checks)
      if (!check.is_acceptable()) return false;
    return !checks.empty();
  }
};

/// What could not be measured, because there was no solution, has failed.
[[nodiscard]] inline Check not_measured(std::string name, std::string why) {
  Check check;
  check.name = std::move(name);
  check.note = std::move(why);
  return check;
}

}  // namespace lefort::verify
