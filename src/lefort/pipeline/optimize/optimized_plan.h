/// \file
/// The text of a plan with new movements.
#pragma once

#include <lefort/inverse/rigid_bodies.h>

#include <span>
#include <string>
#include <vector>

namespace lefort::pipeline {

/// A new path of one segment: one keyframe at its end.
struct NewMovement {
  std::size_t segment = 0;
  RigidTransform X_LB = RigidTransform::Identity();
  Vec3 center_L = Vec3::Zero();  ///< Of the rotation [mm].
};

/// The movements of bodies at numbers x; segments of bodies without a free number are left out.
[[nodiscard]] std::vector<NewMovement> movements_at(const inverse::MotionVariables& variables,
                                                    const VectorX& x);

/// \param json       of a valid plan.
/// \param movements  of segments of the plan.
/// \returns the plan with these paths; steps are kept, all else is unchanged.
[[nodiscard]] std::string with_movements(const std::string& json,
                                         std::span<const NewMovement> movements);

}  // namespace lefort::pipeline
