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

/// Up to this far from the bone every point has a gap: the smooth field answers as far as it is
/// sampled, the trilinear one needs all samples around a point.
[[nodiscard]] inline double reach_mm(const field::DistanceField& field,
                                     Reconstruction reconstruction) {
  return reconstruction == Reconstruction::kSmooth ? field.band_mm() : field.told_mm();
}

}  // namespace lefort::contact
