/// \file
/// Pictures of a plan: the skull after the osteotomies, with colored segments, before and after
/// they move.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/plan/cut_segments.h>
#include <lefort/report/color_map.h>

#include <span>
#include <string>
#include <vector>

namespace lefort::report {

struct PlanPicture {
  std::string file;  ///< "plan_after_front.png".
  std::string png;   ///< The file's bytes.
};

/// Color of fragments on the bone before the motion.
inline constexpr Rgb kFragmentColor{0.80, 0.10, 0.55};

/// Draws the front, the right three-quarter and both profile views, before the motion and at its
/// end. Before the motion, fragments smaller than the segments are colored.
///
/// \param cut       the parts of the skull.
/// \param planned   the segments with their paths.
/// \param progress  of the pictures; may request a stop.
/// \returns the pictures, or the errors of SurfaceScene.
[[nodiscard]] Result<std::vector<PlanPicture>> draw_plan(
    const plan::CutSegments& cut, std::span<const plan::PlannedSegment> planned,
    Progress& progress);

}  // namespace lefort::report
