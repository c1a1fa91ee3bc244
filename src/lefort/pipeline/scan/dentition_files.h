/// \file
/// Intraoral scans of a synthetic head with teeth, and the truth about them.
#pragma once

#include <lefort/anatomy/parametric_head.h>
#include <lefort/core/error.h>
#include <lefort/core/progress.h>

#include <filesystem>

namespace lefort::pipeline {

/// Writes `upper_scan.stl`, `lower_scan.stl`, `bite_scan.stl`, each in a frame of its own with
/// noise of 0.03 mm, and `truth.json`: the motion of each scan into the CT, the motion of the lower
/// jaw of the CT to occlusion, the crowns of the teeth and the canals in the CT. All in mm and LPS.
///
/// \returns nothing, the errors of anatomy::scanned_arch(), kFileUnwritable, or kCancelled.
[[nodiscard]] Result<void> write_dentition_files(const anatomy::ParametricHead& head,
                                                 const std::filesystem::path& folder,
                                                 Progress& progress);

}  // namespace lefort::pipeline
