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

/// Where the teeth of interface and lips come from.
enum class TeethSource {
  kNone,  ///< Interface and lips do not use teeth.
  kAuto,  ///< anatomy::find_teeth(), as `lefort plan check`.
  kFile,  ///< A tooth map.
};
[[nodiscard]] constexpr const char* name_of(TeethSource source) {
  switch (source) {
    case TeethSource::kNone:
      return "none";
    case TeethSource::kAuto:
      return "auto";
    default:
      return "file";
  }
}

/// The input of `lefort predict` and `lefort plan check`.
struct PlanFile {
  std::string title;
  std::optional<std::filesystem::path> ct;      ///< Absolute, from the folder of the plan file.
  std::optional<std::filesystem::path> labels;  ///< Absolute, as `ct`.
  /// Whether interface and lips use the teeth (segmentation.teeth).
  TeethSource teeth_source = TeethSource::kNone;
  std::optional<std::filesystem::path> teeth;  ///< With kFile; absolute, as `ct`.
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

/// A plan with values that are found in its scan: landmarks that are "auto", or autorotation to a
/// gap between the teeth.
struct OpenPlan {
  PlanFile plan;     ///< Without landmarks, segments and options that depend on them.
  std::string json;  ///< As it was read.
  bool needs_landmarks = false;
};

/// Autorotation whose angle is not given: a keyframe of a plan.
struct JawGap {
  std::size_t segment, keyframe;  ///< Numbers.
  double gap_mm;
  std::string upper_jaw;  ///< Name of the segment with the upper teeth; empty: they do not move.
  /// Name of the segment whose angle is taken instead of a gap; empty: the gap decides.
  std::string as{};
};

/// \returns the plan if the scan is needed to complete it, nothing if it is complete; or what
///   read_plan() returns.
[[nodiscard]] Result<std::optional<OpenPlan>> read_open_plan(const std::filesystem::path& file);

/// The text of a plan with the given landmarks in place of its own.
[[nodiscard]] std::string with_landmarks(const std::string& json, const plan::Landmarks& landmarks);

/// The autorotations of a valid plan whose angle is not given, in its order.
[[nodiscard]] std::vector<JawGap> jaw_gaps(const std::string& json);

/// The text of a plan with an angle [degrees] in place of a gap or of the name of a segment.
[[nodiscard]] std::string with_closing(const std::string& json, const JawGap& gap,
                                       double closing_deg);

/// The text of a plan with other teeth (segmentation.teeth): "auto", "none", or a file, whose path
/// becomes absolute.
[[nodiscard]] std::string with_teeth(const std::string& json, const std::string& teeth);

/// Parses a completed plan.
///
/// \param file  the plan, for messages and relative paths.
/// \returns as read_plan_text().
[[nodiscard]] Result<PlanText> parse_completed_plan(const std::filesystem::path& file,
                                                    std::string json);

/// Reads and checks a plan. Landmarks must not be "auto", and autorotation not to a gap
/// (read_open_plan()).
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

/// Checks a plan against its schema. The files that it names are not read.
///
/// \returns nothing, or kPlanInvalid with the key and the error.
[[nodiscard]] Result<void> check_plan_form(std::string_view json);

/// Checks a plan as parse_plan(). If values have to be found in its scan (OpenPlan), only its form
/// is checked.
///
/// \returns warnings, one for each deprecated key; or the errors of parse_plan().
[[nodiscard]] Result<std::vector<std::string>> check_plan(std::string_view json,
                                                          const std::filesystem::path& folder);

/// Returns the text of a plan with new names for its deprecated keys and values; unchanged text if
/// the plan has none. kPlanInvalid if the text is not JSON, or has a key under both names.
[[nodiscard]] Result<std::string> rename_plan_keys(std::string_view json);

}  // namespace lefort::io
