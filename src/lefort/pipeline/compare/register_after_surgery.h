/// \file
/// Achieved movements from a scan after surgery.
#pragma once

#include <lefort/compare/recover_surgery.h>
#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/geometry/triangle_mesh.h>

#include <filesystem>
#include <string>
#include <vector>

namespace lefort::pipeline {

struct SurgeryFound {
  std::string scan_sha256;
  compare::Registration base;     ///< From L to the scan's frame, by unaltered bone.
  geometry::TriangleMesh skin_L;  ///< After surgery, registered on the head before surgery.
  geometry::TriangleMesh bone_L;  ///< As the skin.
  std::vector<compare::AchievedMovement> movements;  ///< One per segment, in the plan's order.
  std::vector<std::string> warnings;
};

/// Segments the scan, registers it on the stationary bone of the prediction and recovers the
/// movement of each segment.
///
/// \param prediction  folder of a finished prediction (`lefort predict`).
/// \param after_ct    the scan after surgery.
/// \param cache       folder for the labels of the scan.
/// \returns the movements; kInvalidArgument if `prediction` is not such a folder; kFileCorrupt if
///   its files do not match; or the errors of io::read_plan(), scan_head(),
///   compare::register_remainder() and compare::recover_movements().
[[nodiscard]] Result<SurgeryFound> find_surgery(const std::filesystem::path& prediction,
                                                const std::filesystem::path& after_ct,
                                                const std::filesystem::path& cache,
                                                Progress& progress);

}  // namespace lefort::pipeline
