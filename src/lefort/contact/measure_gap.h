/// \file
/// How far a point of the tissue is from a moved bone, and in which direction out lies.
#pragma once

#include <lefort/contact/bone_obstacle.h>
#include <lefort/core/types.h>

namespace lefort::contact {

/// The distance field at a point, turned into the patient's frame.
struct Gap {
  field::Zone zone = field::Zone::kOutside;
  double gap_mm = 0.0;             ///< Signed distance; negative is penetration.
  Vec3 gradient_L = Vec3::Zero();  ///< Of gap_mm, out of the bone; of length one but for sampling.
  Mat3 hessian_L = Mat3::Zero();   ///< Of gap_mm [1/mm]; zero unless asked for.
};

/// How far the derivatives of a gap are wanted.
enum class Derivatives { kFirst, kSecond };

/// Reads the field at one point [mm].
///
/// Beyond the band `zone` says on which side, the gap is plus or minus the band and the derivatives
/// are zero: a point deeper than the field can tell is seen, but knows no way out.
/// \note The field never moves: the point goes to the bone's frame, its answer comes back.
[[nodiscard]] Gap measure_gap(const BoneObstacle& obstacle, const Vec3& p_L,
                              Derivatives derivatives = Derivatives::kSecond);

}  // namespace lefort::contact
