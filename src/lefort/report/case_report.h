/// \file
/// What a surgeon is handed after a prediction, as one value. Texts are plain UTF-8; report_html
/// escapes them.
#pragma once

#include <string>
#include <vector>

namespace lefort::report {

/// PNG bytes with what must be said about them.
struct ReportPicture {
  std::string title{};
  std::string caption{};
  std::string png{};
};

/// Two pictures of one view and size, shown on top of each other with a slider.
struct BeforeAfter {
  std::string title{};
  std::string caption{};
  std::string before_png{};
  std::string after_png{};
};

/// One of the few numbers to be seen at a glance.
struct KeyNumber {
  std::string name{};   ///< "largest displacement of the skin"
  std::string value{};  ///< "5.8 mm"
};

struct ReportTable {
  std::string title{};
  std::vector<std::string> heads{};              ///< With units.
  std::vector<std::vector<std::string>> rows{};  ///< First cell names the row; others are numbers.
};

/// How one equilibrium along the path was found.
struct SolverStep {
  double path_fraction = 0.0;                ///< Of the bone's path that is done, 0 to 1.
  std::vector<double> relative_residuals{};  ///< One per Newton iteration, from the first on.
  double max_penetration_mm = 0.0;
  double mean_penetration_mm = 0.0;  ///< Over the area in contact.
};

struct ProvenanceRow {
  std::string name{};  ///< "sha256 of the CT"
  std::string value{};
};

struct CaseReport {
  std::string title{};
  std::string subtitle{};
  std::string plan{};      ///< One sentence: what was planned.
  bool converged = false;  ///< False marks page and pictures as no result.
  std::string failure{};   ///< When not converged: why the solver stopped.

  std::vector<BeforeAfter> comparisons{};
  std::vector<ReportPicture> pictures{};
  std::vector<KeyNumber> key_numbers{};
  std::vector<ReportTable> tables{};

  std::vector<SolverStep> steps{};   ///< In the order of the path.
  double residual_tolerance = 1e-6;  ///< Relative residual that counts as converged.

  std::vector<std::string> notes{};  ///< Warnings, and choices that were left open.
  std::vector<ProvenanceRow> provenance{};
  std::vector<std::string> limitations{};  ///< One paragraph each.
};

}  // namespace lefort::report
