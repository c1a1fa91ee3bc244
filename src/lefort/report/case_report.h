/// \file
/// The content of a report on a prediction or on a cohort. Texts are plain UTF-8; report_html()
/// escapes them.
#pragma once

#include <lefort/report/plot_band.h>
#include <lefort/report/plot_bars.h>
#include <lefort/report/plot_lines.h>

#include <string>
#include <vector>

namespace lefort::report {

/// A PNG file with title and caption.
struct ReportPicture {
  std::string title{};
  std::string caption{};
  std::string png{};
};

/// Two pictures of equal view and size; a slider moves the border between them.
struct BeforeAfter {
  std::string title{};
  std::string caption{};
  std::string before_png{};
  std::string after_png{};
};

/// One of the main results.
struct KeyNumber {
  std::string name{};   ///< "largest displacement of the skin"
  std::string value{};  ///< "5.8 mm"
};

struct ReportTable {
  std::string title{};
  std::vector<std::string> heads{};              ///< Of the columns, with units.
  std::vector<std::vector<std::string>> rows{};  ///< Name of the row, then its values.
};

/// Convergence of the equilibrium at one path fraction.
struct SolverStep {
  double path_fraction = 0.0;                ///< 0 to 1.
  std::vector<double> relative_residuals{};  ///< One per Newton iteration.
  double max_penetration_mm = 0.0;           ///< Of tissue in the obstacle; not the increase.
  double mean_penetration_mm = 0.0;          ///< Over the contact area.
};

struct ProvenanceRow {
  std::string name{};  ///< "sha256 of the CT"
  std::string value{};
};

struct CaseReport {
  std::string title{};
  std::string subtitle{};
  std::string plan{};      ///< One sentence that summarizes the plan.
  bool converged = false;  ///< False: page and pictures are marked as not a result.
  std::string failure{};   ///< If not converged: why the solver stopped.

  std::vector<BeforeAfter> comparisons{};
  std::vector<ReportPicture> pictures{};
  std::string pictures_heading = "Before and after";
  std::vector<KeyNumber> key_numbers{};
  std::vector<ReportTable> tables{};

  std::vector<BandPlot> bands{};  ///< Before the bars and plots, under the same heading.
  std::vector<BarPlot> bars{};
  std::vector<LinePlot> plots{};
  std::string plots_heading = "Plots";

  std::vector<SolverStep> steps{};   ///< In the order of the path.
  double residual_tolerance = 1e-6;  ///< Convergence criterion of the relative residual.

  std::vector<std::string> notes{};  ///< Warnings, and defaults that were used.
  std::vector<ProvenanceRow> provenance{};
  std::vector<std::string> limitations{};  ///< One paragraph each.
};

}  // namespace lefort::report
