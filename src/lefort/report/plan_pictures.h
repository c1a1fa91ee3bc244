/// \file
/// Pictures of a plan: the cut skull, each segment in its color, before and after it moves.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/plan/cut_segments.h>

#include <span>
#include <string>
#include <vector>

namespace lefort::report {

struct PlanPicture {
  std::string file;  ///< "plan_after_front.png".
  std::string png;   ///< The file's bytes.
};

/// From the front, half from the right, and from both sides, before and at the end of the paths.
[[nodiscard]] Result<std::vector<PlanPicture>> draw_plan(
    const plan::CutSegments& cut, std::span<const plan::PlannedSegment> planned,
    Progress& progress);

}  // namespace lefort::report
