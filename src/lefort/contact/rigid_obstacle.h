/// \file
/// A rigid bone that tissue may not enter. Its distance query is given in the frame B of the bone;
/// a plan changes only the pose.
#pragma once

#include <lefort/contact/distance_query.h>
#include <lefort/core/types.h>

#include <memory>

namespace lefort::contact {

/// A distance query with a pose. It may replace a bone by a body at the resolution of the mesh.
struct RigidObstacle {
  std::shared_ptr<const DistanceQuery> distance_query_B;
  RigidTransform X_LB = RigidTransform::Identity();  ///< From the bone in the scan to the patient.
  /// Of the bone that the obstacle replaces (rest_gap.h); null: the obstacle is the bone.
  std::shared_ptr<const DistanceQuery> bone_B = nullptr;
};

}  // namespace lefort::contact
