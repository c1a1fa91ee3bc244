/// \file
/// Writes a prediction into its folder.
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

/// Removes the results of an earlier run, prediction.json first. Otherwise they could be taken for
/// results of a later run that fails. The cache and other files are kept.
///
/// \returns nothing, or kFileUnwritable: a result could not be removed.
[[nodiscard]] Result<void> remove_results(const std::filesystem::path& folder);

/// File name of a segment's result.
///
/// \param name     of the result, for example kBoneOverlap.
/// \param plan     its segments.
/// \param segment  index of the segment.
/// \returns "bone_overlap.vtp"; if the plan has several segments, "bone_overlap_maxilla.vtp".
[[nodiscard]] std::string segment_file(std::string_view name, const io::PlanFile& plan,
                                       std::size_t segment);

inline constexpr const char* kMovedSegment = "bone_segment_moved";
inline constexpr const char* kBoneOverlap = "bone_overlap";

/// bone_overlap.vtp for each segment that overlaps other bone: its initial surface, with the depth
/// of each vertex [mm] at each step with overlap.
///
/// \returns nothing, or kFileUnwritable.
[[nodiscard]] Result<void> write_overlaps(const std::filesystem::path& folder,
                                          const PreparedCase& prepared);

/// predicted_skin.vtp and .stl, skin_before.vtp, bone_remainder.vtp, interface.vtp, and
/// bone_segment_moved.vtp for each segment.
///
/// \returns nothing, or kFileUnwritable.
[[nodiscard]] Result<void> write_surfaces_and_fields(const std::filesystem::path& folder,
                                                     const PreparedCase& prepared,
                                                     const predict::FacePrediction& prediction,
                                                     std::span<const Vec3> skin_displacement_mm);

/// paraview/prediction.pvd with a VTU of the initial state and of each step.
///
/// \returns nothing, or kFileUnwritable.
[[nodiscard]] Result<void> write_paraview(const std::filesystem::path& output,
                                          const PreparedCase& prepared,
                                          const predict::FacePrediction& prediction);

/// Writes the pictures and the plots of the mesh into pictures/ (neither if `pictures` is empty),
/// then report.html and plan.json, and last prediction.json, whose presence shows that all files
/// are complete.
///
/// \returns nothing, or kFileUnwritable.
[[nodiscard]] Result<void> write_documents(const std::filesystem::path& folder,
                                           const report::CaseReport& report,
                                           std::span<const PredictionPicture> pictures,
                                           const mesh::MeshQuality& quality,
                                           std::string_view plan_text,
                                           const nlohmann::ordered_json& prediction);

/// Writes report.html, plan.json and failure.json for a path that did not converge.
///
/// \returns nothing, or kFileUnwritable.
[[nodiscard]] Result<void> write_failure(const std::filesystem::path& folder,
                                         const report::CaseReport& report,
                                         std::string_view plan_text,
                                         const nlohmann::ordered_json& failure);

}  // namespace lefort::pipeline
