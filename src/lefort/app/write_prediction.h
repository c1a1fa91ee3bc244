/// \file
/// Puts a prediction into its folder.
#pragma once

#include <lefort/app/prediction_pictures.h>
#include <lefort/app/prepare_case.h>
#include <lefort/core/error.h>
#include <lefort/predict/face_prediction.h>
#include <lefort/report/case_report.h>

#include <nlohmann/json.hpp>

#include <filesystem>
#include <span>

namespace lefort::app {

/// predicted_skin.vtp and .stl, skin_before.vtp, bones, and paraview/prediction.pvd with a VTU for
/// rest and for each step.
[[nodiscard]] Result<void> write_surfaces_and_fields(const std::filesystem::path& folder,
                                                     const PreparedCase& prepared,
                                                     const predict::FacePrediction& prediction,
                                                     std::span<const Vec3> skin_displacement_mm);

/// pictures/, report.html and, last, prediction.json: where it is, all the rest is.
[[nodiscard]] Result<void> write_documents(const std::filesystem::path& folder,
                                           const report::CaseReport& report,
                                           std::span<const PredictionPicture> pictures,
                                           const nlohmann::ordered_json& prediction);

}  // namespace lefort::app
