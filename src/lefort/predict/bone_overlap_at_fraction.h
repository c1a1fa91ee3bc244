/// \file
/// Bones of a plan on their way, two by two.
#pragma once

#include <lefort/contact/bone_overlap.h>
#include <lefort/contact/distance_query.h>
#include <lefort/geometry/rigid_path.h>
#include <lefort/plan/plan.h>

#include <memory>
#include <string>

namespace lefort::predict {

/// What the bone that stays is called.
inline constexpr const char* kRemainder = "remainder";

/// A bone that follows a path, or stays.
struct MovingBone {
  std::string name;
  const geometry::TriangleMesh* surface_B = nullptr;  ///< Closed. Not owned.
  const geometry::RigidPath* path = nullptr;          ///< Null: it stays. Not owned.
  std::shared_ptr<const contact::DistanceQuery> distance_query_B;
  double cell_mm = 0.0;  ///< Of its field: what is thinner may be missed.

  [[nodiscard]] RigidTransform pose_at(double path_fraction) const;
};

/// Bones that are in each other at one moment.
struct BoneOverlapAtFraction {
  std::string first, second;     ///< Names; kRemainder is the bone that stays.
  double path_fraction = 0.0;    ///< Of the path.
  contact::BoneOverlap overlap;  ///< Depths are of the first's vertices.
};

[[nodiscard]] BoneOverlapAtFraction overlap_at(double path_fraction, const MovingBone& first,
                                               const MovingBone& second);

}  // namespace lefort::predict
