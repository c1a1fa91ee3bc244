/// \file
/// The report of an optimized plan: target and reached face, movements, limits, history.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/pipeline/optimize/optimization.h>
#include <lefort/report/case_report.h>

#include <string>
#include <vector>

namespace lefort::pipeline {

/// A picture for the report and for pictures/.
struct OptimizationPicture {
  std::string file;  ///< "target_right_profile.png".
  std::string title;
  std::string png;
};

/// Draws the certified face with wanted and reached points, and for a target with surfaces the
/// distance from the first.
///
/// \returns the pictures, or the errors of report::SurfaceScene.
[[nodiscard]] Result<std::vector<OptimizationPicture>> draw_optimization(const Optimization& done,
                                                                         Progress& progress);

[[nodiscard]] report::CaseReport optimization_report(
    const Optimization& done, const std::vector<OptimizationPicture>& pictures);

}  // namespace lefort::pipeline
