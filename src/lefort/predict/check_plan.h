/// \file
/// Checks a plan by geometry alone: overlap of bones, gaps, and bony support. Takes seconds.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/field/build/build_distance_field.h>
#include <lefort/plan/cut_segments.h>
#include <lefort/predict/bone_overlap_at_fraction.h>

#include <span>
#include <string>
#include <vector>

namespace lefort::predict {

/// Limits of an acceptable plan.
struct PlanLimits {
  double overlap_mm = 0.5;        ///< Max depth of a bone overlap: a burr can remove this.
  double gap_mm = 10.0;           ///< Max distance of cut faces from other bone.
  double support_mm = 1.0;        ///< Bone within this distance supports a cut face.
  double support_fraction = 0.1;  ///< Min supported fraction of a segment's cut faces.
  double root_mm = 5.0;           ///< Min distance of a cut from tooth roots, if teeth are known.
  double nerve_mm = 2.0;          ///< Min distance of a cut from the canals of nerves, if known.
};

/// Gap and support of a segment's cut faces at the end of its path.
struct SegmentSupport {
  std::string segment;
  double cut_area_mm2 = 0.0;
  double supported_area_mm2 = 0.0;
  double mean_gap_mm = 0.0;
  double max_gap_mm = 0.0;        ///< To the closest other bone.
  Vec3 max_gap_L = Vec3::Zero();  ///< Position of max_gap_mm at the end of the path.

  [[nodiscard]] double supported_fraction() const {
    return cut_area_mm2 > 0.0 ? supported_area_mm2 / cut_area_mm2 : 0.0;
  }
};

enum class FindingKind { kOverlap, kGap, kMissingSupport, kToothRoot, kNerve };

/// One violated limit.
struct PlanFinding {
  FindingKind kind;
  std::string segment;  ///< The first, if two are involved.
  std::string text;     ///< A sentence.
};

/// \returns "overlap", "gap", "missing_support", "tooth_root", "nerve".
[[nodiscard]] const char* name_of(FindingKind kind);

struct PlanCheck {
  std::vector<BoneOverlapAtFraction> overlaps;  ///< The deepest of each pair that overlaps.
  std::vector<SegmentSupport> supports;         ///< One for each segment.
  std::vector<PlanFinding> findings;            ///< Empty if all limits that were checked are met.
};

/// Moves all segments together along their paths and checks all limits except PlanLimits::root_mm
/// and PlanLimits::nerve_mm, which pipeline/plan/check_plan_file.cpp checks.
///
/// Overlap is measured at every step of the path with the most steps and at every keyframe. Cut
/// faces are the parts of a segment's surface that at rest lie within the kerf width plus
/// contact::kTouching_mm of other bone. Gap and support of a distracted segment are reported, but
/// are not findings: new bone grows there.
///
/// \param cut       result of cut_segments().
/// \param planned   the plan that was cut; paths pass check_path().
/// \param limits    of an acceptable plan.
/// \param field     resolution of overlap; the band limits the depths.
/// \param progress  may stop the check.
/// \returns the measurements and findings; or what field::build_distance_field() returns, or
///   kCancelled.
[[nodiscard]] Result<PlanCheck> check_plan(const plan::CutSegments& cut,
                                           std::span<const plan::PlannedSegment> planned,
                                           const PlanLimits& limits,
                                           field::DistanceFieldOptions field,
                                           Progress& progress = Progress::none());

}  // namespace lefort::predict
