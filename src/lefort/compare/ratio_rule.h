/// \file
/// The ratio rule, with which finite-element predictions are compared: skin moves by a fixed
/// fraction of the displacement of the closest bone.
#pragma once

#include <lefort/compare/face_regions.h>
#include <lefort/geometry/triangle_mesh.h>

#include <span>
#include <vector>

namespace lefort::compare {

/// Ratio of soft to hard tissue movement. Centers of the ranges of a systematic review of profile
/// ratios \cite olate2016 are used: chin, soft pogonion to pogonion 0.9 to 1; lower lip,
/// mentolabial fold to point B 1; upper lip, Ls to U1 0.6 to 1; nose, subnasale to ANS 0.6 to 0.9.
/// The cheeks, which have no profile ratios, have that of the nose. Skin outside all regions does
/// not move.
///
/// \param region  of the face.
/// \returns the ratio, 0 to 1.
[[nodiscard]] double soft_to_hard_ratio(FaceRegion region);

/// A bone of the rule.
struct MovedBone {
  const geometry::TriangleMesh* surface_B;  ///< Before the movement.
  RigidTransform X_LB;                      ///< The movement; the identity for stationary bone.
};

/// Moves each point of the skin by the ratio of its region times the displacement that it would
/// have if it moved rigidly with the closest bone.
///
/// \param skin_L     before surgery.
/// \param region_of  one per vertex.
/// \param bones      all segments and the stationary bone.
/// \returns the skin after surgery, with the same triangles.
[[nodiscard]] geometry::TriangleMesh apply_ratio_rule(geometry::TriangleMesh skin_L,
                                                      std::span<const FaceRegion> region_of,
                                                      std::span<const MovedBone> bones);

}  // namespace lefort::compare
