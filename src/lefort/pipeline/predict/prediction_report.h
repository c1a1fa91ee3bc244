/// \file
/// A prediction as the value that report_html turns into a page.
#pragma once

#include <lefort/pipeline/json/prediction_json.h>
#include <lefort/pipeline/predict/prediction_pictures.h>
#include <lefort/pipeline/prepare/prepare_case.h>
#include <lefort/predict/face_prediction.h>
#include <lefort/report/case_report.h>

#include <span>

namespace lefort::pipeline {

[[nodiscard]] report::CaseReport prediction_report(const PreparedCase& prepared,
                                                   const predict::FacePrediction& prediction,
                                                   std::span<const PredictionPicture> pictures,
                                                   const predict::SkinDisplacement& skin,
                                                   const Timing& timing);

}  // namespace lefort::pipeline
