/// \file
/// The bone movements achieved by surgery, from the skull after surgery.
#pragma once

#include <lefort/compare/register_segment.h>
#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/geometry/triangle_mesh.h>

#include <string>
#include <vector>

namespace lefort::compare {

/// The bones of a plan.
struct PlannedBones {
  geometry::TriangleMesh remainder_L;              ///< Bone that the plan does not move.
  std::vector<std::string> segments;               ///< Names.
  std::vector<geometry::TriangleMesh> segments_B;  ///< One per segment, before the movement.
  std::vector<RigidTransform> planned_LB;          ///< One per segment: its planned pose.
  double kerf_mm = 0.0;  ///< Largest kerf: two osteotomies can cut the same segment.
};

/// The movement of one segment.
struct AchievedMovement {
  std::string segment;
  RigidTransform planned_LB;
  Registration achieved;        ///< X_LB.
  MovementDifference movement;  ///< From the position before surgery to the achieved one.
  MovementDifference error;     ///< From the planned position to the achieved one.
};

/// Registers the skull after surgery on bone that surgery did not alter.
///
/// \param bones         of the plan.
/// \param skull_after   after surgery, in its scan's frame.
/// \returns the motion from L to the scan's frame, or the errors of register_surface().
[[nodiscard]] Result<Registration> register_remainder(const PlannedBones& bones,
                                                      const geometry::TriangleMesh& skull_after,
                                                      Progress& progress = Progress::none());

/// Registers each segment on the bone after surgery.
///
/// \param bones    of the plan; `segments`, `segments_B` and `planned_LB` have the same size.
/// \param after_L  bone after surgery, registered by register_remainder().
/// \returns one movement per segment, or the errors of register_segment().
[[nodiscard]] Result<std::vector<AchievedMovement>> recover_movements(
    const PlannedBones& bones, const geometry::TriangleMesh& after_L,
    Progress& progress = Progress::none());

}  // namespace lefort::compare
