/// \file
/// A scan as it would be after its points have moved.
#pragma once

#include <lefort/core/types.h>
#include <lefort/image/volume.h>

#include <span>
#include <vector>

namespace lefort::anatomy {

/// A point before the movement, and its displacement.
struct MovedPoint {
  Vec3 point_L, shift_mm;
};

/// A smooth field through scattered displacements.
class DisplacementField {
 public:
  /// Normalized convolution \cite knutsson1993 of the displacements with a filter of 5 mm
  /// (standard deviation; three box filters) on a grid of 2 mm. Where points end, it fades over
  /// twice the largest displacement (8 to 40 mm), from 4 mm on. Points on both sides of a gap
  /// narrower than the filter are averaged: a gap moves rather than widens.
  ///
  /// \param points  finite.
  /// \param box_L   where the field is needed. \pre up to 10^8 nodes.
  DisplacementField(std::span<const MovedPoint> points, const Box3& box_L);

  /// Displacement of a point before the movement.
  [[nodiscard]] Vec3 at(const Vec3& p_L) const;

  /// \returns the point before the movement that is at `q_L` after it, by fixed-point iterations;
  ///   exact to 0.01 mm where the displacement changes by less than half a millimeter per
  ///   millimeter.
  [[nodiscard]] Vec3 before(const Vec3& q_L) const;

 private:
  image::Grid grid_;
  std::vector<Vec3> shifts_mm_;
};

/// \param volume   before the movement.
/// \param outside  value beyond the volume.
/// \returns the volume after it, on the same grid: CT numbers are interpolated.
[[nodiscard]] image::CtVolume warped(const image::CtVolume& volume, const DisplacementField& field,
                                     std::int16_t outside);

}  // namespace lefort::anatomy
