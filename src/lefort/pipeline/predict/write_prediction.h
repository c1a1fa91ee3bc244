/// \file
/// Puts a prediction into its folder.
#pragma once

#include <lefort/core/error.h>
#include <lefort/pipeline/predict/prediction_pictures.h>
#include <lefort/pipeline/prepare/prepare_case.h>
#include <lefort/predict/face_prediction.h>
#include <lefort/report/case_report.h>

#include <nlohmann/json.hpp>

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace lefort::pipeline {

/// Takes an earlier run's results out of a folder, prediction.json first: whatever becomes of the
/// run that begins, nothing there passes for its result. The cache stays, and files of others.
///
/// \returns nothing, or kFileUnwritable: a result could not be removed.
[[nodiscard]] Result<void> remove_results(const std::filesystem::path& folder);

/// "bone_overlap.vtp"; of a plan of several segments with the segment's name,
/// "bone_overlap_maxilla.vtp".
[[nodiscard]] std::string segment_file(std::string_view name, const io::PlanFile& plan,
                                       std::size_t segment);

inline constexpr const char* kMovedSegment = "bone_segment_moved";
inline constexpr const char* kBoneOverlap = "bone_overlap";

/// bone_overlap.vtp for each segment that is driven into other bone: at rest, with the depth of
/// each vertex there for each step that does.
[[nodiscard]] Result<void> write_overlaps(const std::filesystem::path& folder,
                                          const PreparedCase& prepared);

/// predicted_skin.vtp and .stl, skin_before.vtp, bone_remainder.vtp, bone_segment_moved.vtp for
/// each segment, and paraview/prediction.pvd with a VTU for rest and for each step.
[[nodiscard]] Result<void> write_surfaces_and_fields(const std::filesystem::path& folder,
                                                     const PreparedCase& prepared,
                                                     const predict::FacePrediction& prediction,
                                                     std::span<const Vec3> skin_displacement_mm);

/// pictures/ with the mesh's plots, report.html, plan.json, last prediction.json: then all is in.
[[nodiscard]] Result<void> write_documents(const std::filesystem::path& folder,
                                           const report::CaseReport& report,
                                           std::span<const PredictionPicture> pictures,
                                           const mesh::MeshQuality& quality,
                                           std::string_view plan_text,
                                           const nlohmann::ordered_json& prediction);

/// The same for a path that could not be followed: report.html, plan.json and failure.json.
[[nodiscard]] Result<void> write_failure(const std::filesystem::path& folder,
                                         const report::CaseReport& report,
                                         std::string_view plan_text,
                                         const nlohmann::ordered_json& failure);

}  // namespace lefort::pipeline
