/// \file
/// The movements of a plan in the terms of a surgeon, as a table and as a sheet for the operating
/// room.
#pragma once

#include <lefort/core/error.h>
#include <lefort/plan/cut_segments.h>
#include <lefort/plan/head_directions.h>
#include <lefort/plan/landmarks.h>
#include <lefort/predict/check_plan.h>
#include <lefort/report/plan_pictures.h>

#include <nlohmann/json.hpp>

#include <span>
#include <string>
#include <vector>

namespace lefort::pipeline {

/// The movement of one segment.
struct MovementOfSegment {
  std::string segment;
  plan::MovementTerms whole;  ///< The translation is that of the center of its surface.
  /// Its landmarks on bone and teeth; the rotation is that of `whole`.
  std::vector<std::pair<std::string, plan::MovementTerms>> landmarks;
};

/// \param directions  of the head.
/// \returns the movement of each segment that moves, in the order of the plan.
[[nodiscard]] std::vector<MovementOfSegment> segment_movements(
    const plan::HeadDirections& directions, const plan::Landmarks& landmarks,
    const plan::CutSegments& cut, std::span<const plan::PlannedSegment> planned);

/// A splint or a cutting guide.
struct WorksheetPart {
  std::string kind, name;
  std::string sha256;  ///< Printed shortened: two files of one name differ.
};

/// What is printed beside the movements.
struct WorksheetNotes {
  std::string title;        ///< Of the plan.
  std::string plan_sha256;  ///< Printed shortened, so that sheets of two plans differ.
  bool has_frankfurt_horizontal = false;
  std::vector<WorksheetPart> parts = {};
};

/// "5.0 forward" or "5.0 back"; "-" below 0.05 mm.
[[nodiscard]] std::string movement_in_words(double value, const char* positive,
                                            const char* negative);

[[nodiscard]] nlohmann::json movements_json(std::span<const MovementOfSegment> movements);

/// `segment,point,anterior_mm,left_mm,superior_mm,yaw_deg,pitch_deg,roll_deg`; the point is a
/// landmark, or "center".
[[nodiscard]] std::string movements_csv(std::span<const MovementOfSegment> movements);

/// \param notes     of the plan.
/// \param movements of its segments.
/// \param findings  of the check.
/// \param pictures  of the plan; may be empty.
/// \returns the bytes of a PDF, or the errors of report::sheet_pdf().
[[nodiscard]] Result<std::string> worksheet_pdf(const WorksheetNotes& notes,
                                                std::span<const MovementOfSegment> movements,
                                                std::span<const predict::PlanFinding> findings,
                                                std::span<const report::PlanPicture> pictures);

}  // namespace lefort::pipeline
