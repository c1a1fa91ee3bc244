/// \file
/// Whether bones can go where a plan sends them: told in seconds, before anything is solved.
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

/// What counts as impossible.
struct PlanLimits {
  double overlap_mm = 0.5;        ///< Bone may be this deep in bone: what a burr takes off.
  double gap_mm = 10.0;           ///< Cut faces may come to lie this far from other bone.
  double support_mm = 1.0;        ///< Bone nearer than this to a cut face supports it.
  double support_fraction = 0.1;  ///< This part of a segment's cut faces must be supported.
};

/// How a segment's cut faces lie at the end of its path.
struct SegmentSupport {
  std::string segment;
  double cut_area_mm2 = 0.0;
  double supported_area_mm2 = 0.0;
  double mean_gap_mm = 0.0;
  double max_gap_mm = 0.0;        ///< To the nearest other bone.
  Vec3 max_gap_L = Vec3::Zero();  ///< Where that is, at the end of the path.

  [[nodiscard]] double supported_fraction() const {
    return cut_area_mm2 > 0.0 ? supported_area_mm2 / cut_area_mm2 : 0.0;
  }
};

enum class FindingKind { kOverlap, kGap, kMissingSupport };

/// One thing that makes a plan impossible.
struct PlanFinding {
  FindingKind kind;
  std::string segment;  ///< The first, of two.
  std::string text;     ///< A sentence.
};

/// \returns "overlap", "gap", "missing_support".
[[nodiscard]] const char* name_of(FindingKind kind);

struct PlanCheck {
  std::vector<BoneOverlapAtFraction>
      overlaps;                          ///< The deepest of each pair that more than touches.
  std::vector<SegmentSupport> supports;  ///< One a segment.
  std::vector<PlanFinding> findings;     ///< Empty: the plan can be done.
};

/// Moves all segments together along their paths.
///
/// Bones are compared at every step of the longest path and at every keyframe. Cut faces are those
/// that lie on other bone, or a saw's width from it, before anything moves. Gap and support of a
/// segment that is distracted are told, but are no finding: new bone grows there.
///
/// \param cut      as cut_segments() made it.
/// \param planned  the plan it was made of; paths pass check_path().
/// \param field    how finely overlap is looked for; what is deeper than its band counts as that.
/// \returns what building a distance field returns, or kCancelled.
[[nodiscard]] Result<PlanCheck> check_plan(const plan::CutSegments& cut,
                                           std::span<const plan::PlannedSegment> planned,
                                           const PlanLimits& limits,
                                           field::DistanceFieldOptions field,
                                           Progress& progress = Progress::none());

}  // namespace lefort::predict
