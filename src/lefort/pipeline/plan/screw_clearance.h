/// \file
/// The distance of screws from the roots of teeth and the canals of nerves.
#pragma once

#include <lefort/core/types.h>
#include <lefort/dental/number_teeth.h>
#include <lefort/predict/nerve_distances.h>

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lefort::pipeline {

/// What a screw comes closest to.
struct ScrewNeighbor {
  /// From the axis of the screw to the voxels of the root, or to the wall of the canal.
  double distance_mm = 0.0;
  std::string name;  ///< "tooth 13" or "right canal"; empty if nothing is near.
};

/// Teeth and canals near a place.
class ScrewClearance {
 public:
  /// \param teeth    crowns and roots.
  /// \param numbers  of the teeth; null: unknown.
  /// \param nerves   canals before the movement.
  /// \param box_L    where screws are.
  ScrewClearance(const anatomy::ToothMap& teeth, const dental::NumberedTeeth* numbers,
                 std::span<const predict::NerveTube> nerves, const Box3& box_L);

  /// \returns the closest neighbor of a screw between two points; its distance is infinity if there
  ///   is none within about 15 mm of the box.
  [[nodiscard]] ScrewNeighbor closest(const Vec3& from_L, const Vec3& to_L) const;

 private:
  struct ToothPoint {
    Vec3 center_L;
    int fdi;
  };
  std::vector<ToothPoint> teeth_;
  double half_voxel_mm_ = 0.0;              ///< Half of the diagonal of a voxel.
  std::vector<predict::NerveTube> nerves_;  ///< With lines of 0.5 mm.
};

}  // namespace lefort::pipeline
