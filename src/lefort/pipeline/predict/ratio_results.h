/// \file
/// Soft-tissue ratios as JSON and as tables of the report.
#pragma once

#include <lefort/pipeline/predict/ratio_deviation.h>
#include <lefort/report/case_report.h>

#include <nlohmann/json.hpp>

#include <span>
#include <vector>

namespace lefort::pipeline {

/// \returns `soft_tissue_ratios` of contract/prediction.schema.json.
[[nodiscard]] nlohmann::ordered_json ratios_json(std::span<const ExplainedRatio> ratios);

/// \returns up to three tables: the ratios beside published ranges; if any deviate, the reasons; if
///   any have a published range, its sources. Empty if `ratios` is empty.
[[nodiscard]] std::vector<report::ReportTable> ratio_tables(std::span<const ExplainedRatio> ratios);

}  // namespace lefort::pipeline
