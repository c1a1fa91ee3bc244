/// \file
/// From a scan after surgery to the movements that were achieved.
#pragma once

#include <lefort/compare/register_segment.h>
#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/geometry/triangle_mesh.h>

#include <filesystem>
#include <string>
#include <vector>

namespace lefort::pipeline {

/// A segment and what became of it.
struct AchievedMovement {
  std::string segment;
  RigidTransform planned_LB;
  compare::Registration achieved;        ///< X_LB.
  compare::MovementDifference movement;  ///< From rest to where it went.
  compare::MovementDifference error;     ///< From the plan to where it went.
};

struct SurgeryFound {
  std::string scan_sha256;
  compare::Registration base;     ///< From L to the scan's frame, on bone that did not move.
  geometry::TriangleMesh skin_L;  ///< After surgery, laid onto the head before it.
  geometry::TriangleMesh bone_L;  ///< Likewise.
  std::vector<AchievedMovement> movements;  ///< One per segment, in the plan's order.
  std::vector<std::string> warnings;
};

/// Segments the scan, registers it on the still bone of the prediction and finds where the
/// segments went.
///
/// \param prediction  a folder of `lefort predict` that holds a finished prediction.
/// \param cache       folder that keeps the scan's labels.
/// \returns kInvalidArgument if the folder is none, or what reading, segmenting and registering
///   return.
[[nodiscard]] Result<SurgeryFound> find_surgery(const std::filesystem::path& prediction,
                                                const std::filesystem::path& after_ct,
                                                const std::filesystem::path& cache,
                                                Progress& progress);

}  // namespace lefort::pipeline
