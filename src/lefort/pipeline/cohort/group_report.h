/// \file
/// The results of a cohort with all parameter sets as JSON, CSV, plots and a page.
#pragma once

#include <lefort/pipeline/cohort/group_results.h>
#include <lefort/report/case_report.h>

#include <nlohmann/json.hpp>

#include <string>
#include <utility>
#include <vector>

namespace lefort::pipeline {

[[nodiscard]] nlohmann::ordered_json group_json(const GroupResults& results);

/// One line per evaluation.
[[nodiscard]] std::string group_csv(const GroupResults& results);

/// One line per evaluation, region and method: the columns of validation.csv after that of the set.
/// Only evaluations with a face after surgery.
[[nodiscard]] std::string regions_csv(const GroupResults& results);

/// Name of the file, and plot.
[[nodiscard]] std::vector<std::pair<std::string, report::LinePlot>> group_plots(
    const GroupResults& results);

[[nodiscard]] report::CaseReport group_report(const GroupResults& results);

/// A few lines for the terminal.
[[nodiscard]] std::string group_text(const GroupResults& results);

}  // namespace lefort::pipeline
