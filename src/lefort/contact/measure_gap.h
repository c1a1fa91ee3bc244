/// \file
/// Gap of tissue points to a rigid body at its pose.
#pragma once

#include <lefort/contact/rigid_obstacle.h>
#include <lefort/core/types.h>

#include <cstddef>
#include <span>
#include <utility>

namespace lefort::contact {

/// Bound of the length of the gradient of a sampled distance; that of the distance is 1.
inline constexpr double kMaxGapSlope = 1.1;

/// A SignedDistanceSample in the frame of the patient. The table of zones there applies.
struct Gap {
  field::Zone zone = field::Zone::kOutside;
  double gap_mm = 0.0;  ///< Signed distance; negative means penetration.
  /// Of gap_mm; outward, of unit length except for sampling errors.
  Vec3 gradient_L = Vec3::Zero();
  Mat3 hessian_L = Mat3::Zero();  ///< Of gap_mm [1/mm]; zero if not computed.
};

/// Measures many points, in parallel if there are more than kParallelBlock. The points are
/// transformed into the frame of the body and the results back. The result at a point does not
/// depend on the other points.
///
/// \param obstacle     the body at its pose.
/// \param p_L          points [mm].
/// \param derivatives  that are computed.
/// \param gaps         one per point.
void measure_gaps(const RigidObstacle& obstacle, std::span<const Vec3> p_L, Derivatives derivatives,
                  std::span<Gap> gaps);

/// Measures one point [mm]; parameters as above.
[[nodiscard]] Gap measure_gap(const RigidObstacle& obstacle, const Vec3& p_L,
                              Derivatives derivatives = Derivatives::kSecond);

/// \param obstacles  bodies at their poses; at least one.
/// \returns the gap of a point to the closest body, with first derivatives, and the body's number.
[[nodiscard]] std::pair<Gap, std::size_t> closest_gap(std::span<const RigidObstacle> obstacles,
                                                      const Vec3& p_L);

}  // namespace lefort::contact
