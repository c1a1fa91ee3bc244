/// \file
/// The results of a cohort as JSON, CSV, HTML and text.
#pragma once

#include <lefort/pipeline/validate.h>
#include <lefort/pipeline/validate/case_result.h>
#include <lefort/pipeline/validate/cohort_statistics.h>
#include <lefort/report/case_report.h>

#include <nlohmann/json.hpp>

#include <span>
#include <string>
#include <vector>

namespace lefort::pipeline {

/// A cohort with its statistics.
struct CohortResults {
  std::vector<CaseResult> cases;
  std::vector<CohortRegion> regions;
  compare::BootstrapOptions bootstrap;
};

/// Mean and interval; null if not finite.
[[nodiscard]] nlohmann::ordered_json value_json(const CohortValue& value);

[[nodiscard]] nlohmann::ordered_json region_json(const CohortRegion& region);

[[nodiscard]] nlohmann::ordered_json cohort_json(const CohortResults& results,
                                                 const ValidateJob& job);

/// One line per case, region and method; a case that failed has one line with the reason.
[[nodiscard]] std::string cohort_csv(const CohortResults& results);

/// \param pictures  of the cases; may be empty.
[[nodiscard]] report::CaseReport cohort_report(const CohortResults& results,
                                               std::vector<report::ReportPicture> pictures);

/// A few lines for the terminal.
[[nodiscard]] std::string cohort_text(const CohortResults& results);

/// "1.20 [1.05, 1.40]"; "-" if there is no value.
[[nodiscard]] std::string in_words(const CohortValue& value, int digits);

/// Quotes a field of a CSV if necessary.
[[nodiscard]] std::string csv_field(const std::string& text);

}  // namespace lefort::pipeline
