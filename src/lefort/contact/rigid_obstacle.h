/// \file
/// A rigid bone that tissue may not enter. Whoever detects it knows it in its own frame B; a plan
/// only moves the pose.
#pragma once

#include <lefort/contact/distance_query.h>
#include <lefort/core/types.h>

#include <memory>

namespace lefort::contact {

struct RigidObstacle {
  std::shared_ptr<const DistanceQuery> distance_query_B;
  RigidTransform X_LB = RigidTransform::Identity();  ///< From the bone as scanned to the patient.
};

}  // namespace lefort::contact
