/// \file
/// The plan on disk: JSON, validated against contract/plan.schema.json and checked for consistency.
#pragma once

#include <lefort/anatomy/segment_tissue.h>
#include <lefort/core/error.h>
#include <lefort/field/build/build_distance_field.h>
#include <lefort/plan/cut_segments.h>
#include <lefort/plan/landmarks.h>
#include <lefort/predict/prediction_options.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lefort::io {

/// The input of `lefort predict` and `lefort plan check`.
struct PlanFile {
  std::string title;
  std::optional<std::filesystem::path> ct;      ///< Absolute, from the folder of the plan file.
  std::optional<std::filesystem::path> labels;  ///< Absolute, as `ct`.
  anatomy::SegmentationOptions segmentation;
  plan::Landmarks landmarks;                   ///< Before surgery; may be empty.
  std::vector<plan::PlannedSegment> segments;  ///< One or more.
  predict::TissueOptions tissue;
  predict::BoundaryOptions boundary;
  std::optional<std::filesystem::path> boundary_labels;  ///< Absolute, as `ct`.
  predict::ContactOptions contact;
  field::DistanceFieldOptions field;
  predict::SolverOptions solver;
  std::vector<std::string> warnings;  ///< One for each deprecated key.
};

/// A plan and its text; the file is read only once, so that both agree.
struct PlanText {
  PlanFile plan;
  std::string json;
};

/// A plan whose landmarks are "auto".
struct PlanForLandmarks {
  PlanFile plan;     ///< Only title, scan, labels and segmentation options.
  std::string json;  ///< Text of the file.
};

/// \returns the plan if its landmarks are "auto", nothing if they are not; or kFileNotFound,
///   kFileCorrupt or kPlanInvalid as read_plan().
[[nodiscard]] Result<std::optional<PlanForLandmarks>> read_plan_for_landmarks(
    const std::filesystem::path& file);

/// The plan with the given landmarks in place of "auto".
///
/// \param open       the plan with "auto".
/// \param landmarks  of the scan.
/// \param file       the plan, for messages and relative paths.
/// \returns as read_plan_text(); the text of the result contains the landmarks.
[[nodiscard]] Result<PlanText> with_landmarks(const PlanForLandmarks& open,
                                              const plan::Landmarks& landmarks,
                                              const std::filesystem::path& file);

/// Reads and checks a plan. Landmarks must not be "auto" (read_plan_for_landmarks()).
///
/// Files that the plan names (landmarks, targets, transforms, planes, curves) are also read, except
/// the scan and labels.
///
/// \returns the plan; kFileNotFound; kFileCorrupt if the file is larger than 4 MiB; the errors of
///   reading a named file; or kPlanInvalid with the key and the error, for example `tissue: unknown
///   key "color"`. A key that occurs twice in an object is an error, because parsers differ on it.
[[nodiscard]] Result<PlanFile> read_plan(const std::filesystem::path& file);
[[nodiscard]] Result<PlanText> read_plan_text(const std::filesystem::path& file);

/// As read_plan() from text; relative paths are taken from `folder`.
[[nodiscard]] Result<PlanFile> parse_plan(std::string_view json,
                                          const std::filesystem::path& folder);

/// Returns the text of a plan with new names for its deprecated keys and values; unchanged text if
/// the plan has none. kPlanInvalid if the text is not JSON, or has a key under both names.
[[nodiscard]] Result<std::string> rename_plan_keys(std::string_view json);

}  // namespace lefort::io
