/// \file
/// Overlap of two bones of a plan at one path fraction.
#pragma once

#include <lefort/contact/bone_overlap.h>
#include <lefort/contact/distance_query.h>
#include <lefort/geometry/rigid_path.h>
#include <lefort/plan/plan.h>

#include <memory>
#include <string>

namespace lefort::predict {

/// Name of the bone left after all osteotomies.
inline constexpr const char* kRemainder = "remainder";

/// A bone that follows a path or is stationary.
struct MovingBone {
  std::string name;
  const geometry::TriangleMesh* surface_B = nullptr;  ///< Closed. Not owned.
  const geometry::RigidPath* path = nullptr;          ///< Null if stationary. Not owned.
  std::shared_ptr<const contact::DistanceQuery> distance_query_B;
  double cell_mm = 0.0;  ///< Of its field; thinner overlap may be missed.

  [[nodiscard]] RigidTransform pose_at(double path_fraction) const;
};

/// Two bones that overlap at one path fraction.
struct BoneOverlapAtFraction {
  std::string first, second;  ///< Names; kRemainder for the remainder.
  double path_fraction = 0.0;
  contact::BoneOverlap overlap;
};

/// Overlap of two bones, both posed at `path_fraction`.
[[nodiscard]] BoneOverlapAtFraction overlap_at(double path_fraction, const MovingBone& first,
                                               const MovingBone& second);

}  // namespace lefort::predict
