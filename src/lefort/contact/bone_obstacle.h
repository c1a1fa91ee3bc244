/// \file
/// A rigid bone that tissue may not enter. Its field is built once, in the bone's own frame B; a
/// plan only moves the pose.
#pragma once

#include <lefort/core/types.h>
#include <lefort/field/distance_field.h>

#include <memory>

namespace lefort::contact {

/// How the field is read between its samples.
enum class Reconstruction {
  kTrilinear,  ///< The paper's, section 2.2. Its gradient jumps at cell faces.
  kSmooth,     ///< Twice continuously differentiable; contact tangents are then exact.
};

struct BoneObstacle {
  std::shared_ptr<const field::DistanceField> field_B;
  RigidTransform X_LB = RigidTransform::Identity();  ///< From the bone as scanned to the patient.
  Reconstruction reconstruction = Reconstruction::kSmooth;
};

}  // namespace lefort::contact
