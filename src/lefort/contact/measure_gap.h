/// \file
/// How far a point of the tissue is from a moved bone, and in which direction out lies.
#pragma once

#include <lefort/contact/bone_obstacle.h>
#include <lefort/core/types.h>

#include <span>
#include <vector>

namespace lefort::contact {

/// The distance field at a point, turned into the patient's frame.
struct Gap {
  field::Zone zone = field::Zone::kOutside;
  double gap_mm = 0.0;             ///< Signed distance; negative is penetration.
  Vec3 gradient_L = Vec3::Zero();  ///< Of gap_mm, out of the bone; of length one but for sampling.
  Mat3 hessian_L = Mat3::Zero();   ///< Of gap_mm [1/mm]; zero for the trilinear reconstruction.
};

/// Reads the field at one point [mm].
///
/// Beyond the band `zone` says on which side, the gap is plus or minus the band and the derivatives
/// are zero: a point deeper than the field can tell is seen, but knows no way out.
/// \note The field never moves: the point goes to the bone's frame, its answer comes back.
[[nodiscard]] Gap measure_gap(const BoneObstacle& obstacle, const Vec3& p_L);

/// One queried point that lies nearer to the bone than a margin.
struct ContactPoint {
  Index point = 0;  ///< Position in the span of queried points.
  Gap gap;
};

/// Finds the points that lie nearer to the bone than `margin_mm`, or deeper than the band (paper,
/// section 2.2).
///
/// \returns contacts in the order of `points_L`, the same for any number of threads.
[[nodiscard]] std::vector<ContactPoint> find_contacts(const BoneObstacle& obstacle,
                                                      std::span<const Vec3> points_L,
                                                      double margin_mm);

}  // namespace lefort::contact
