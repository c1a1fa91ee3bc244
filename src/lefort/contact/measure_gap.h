/// \file
/// How far points of the tissue are from a moved bone, and in which direction out lies.
#pragma once

#include <lefort/contact/rigid_obstacle.h>
#include <lefort/core/types.h>

#include <span>

namespace lefort::contact {

/// What the obstacle's detector says of a point, turned into the patient's frame; see
/// SignedDistanceSample.
struct Gap {
  field::Zone zone = field::Zone::kOutside;
  double gap_mm = 0.0;             ///< Signed distance; negative is penetration.
  Vec3 gradient_L = Vec3::Zero();  ///< Of gap_mm, out of the bone; of length one but for sampling.
  Mat3 hessian_L = Mat3::Zero();   ///< Of gap_mm [1/mm]; zero unless asked for.
};

/// Measures many points at once [mm], in parallel where they are many. A point alone gets the same
/// bits as among others.
///
/// \param gaps  as many as points.
/// \note The bone never moves: the points go to its frame, the answers come back.
void measure_gaps(const RigidObstacle& obstacle, std::span<const Vec3> p_L, Derivatives derivatives,
                  std::span<Gap> gaps);

/// One point [mm].
[[nodiscard]] Gap measure_gap(const RigidObstacle& obstacle, const Vec3& p_L,
                              Derivatives derivatives = Derivatives::kSecond);

}  // namespace lefort::contact
