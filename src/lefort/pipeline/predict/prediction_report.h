/// \file
/// The report of a prediction as a value, which report_html() formats.
#pragma once

#include <lefort/pipeline/json/prediction_json.h>
#include <lefort/pipeline/predict/prediction_pictures.h>
#include <lefort/pipeline/prepare/prepare_case.h>
#include <lefort/predict/face_prediction.h>
#include <lefort/report/case_report.h>

#include <optional>
#include <span>

namespace lefort::pipeline {

/// Collects the figures and pictures of a report.
///
/// \param pictures  may be empty.
/// \param skin      of the last step.
/// \param timing    none: the report has no table of times.
[[nodiscard]] report::CaseReport prediction_report(const PreparedCase& prepared,
                                                   const predict::FacePrediction& prediction,
                                                   std::span<const PredictionPicture> pictures,
                                                   const predict::SkinDisplacementStatistics& skin,
                                                   const std::optional<Timing>& timing);

}  // namespace lefort::pipeline
