/// \file
/// The axis about which the mandible rotates in its joints.
#pragma once

#include <lefort/core/error.h>
#include <lefort/geometry/bvh.h>
#include <lefort/geometry/rigid_path.h>
#include <lefort/plan/landmarks.h>

#include <span>
#include <vector>

namespace lefort::plan {

/// The line through the centers of both condyles.
struct CondylarAxis {
  Vec3 right_L, left_L;  ///< Centers of the condyles [mm].

  [[nodiscard]] Vec3 middle_L() const { return 0.5 * (right_L + left_L); }
};

/// The axis of a mandible in its joints \cite brekke1959. The center of a condyle is midway between
/// its lateral and its medial pole (Cdl and Cdm).
///
/// \param landmarks  with Cdl and Cdm on both sides.
/// \returns the axis; or kPlanInvalid, naming the landmark, if one is missing; or if the condyles
///   are less than 50 mm apart, or exchanged (patient_left_axis()).
[[nodiscard]] Result<CondylarAxis> condylar_axis(std::span<const Landmark> landmarks);

/// Autorotation: the mandible rotates about the axis of its condyles, without translation.
///
/// The real center of rotation differs between patients; on average it lies below the condyle
/// \cite nadjmi1998 \cite wang2006. docs/guide/osteotomies.md has the size of the error.
///
/// \param axis         from condylar_axis().
/// \param closing_deg  positive: the chin moves up and forward, as after impaction of the maxilla.
/// \returns the pose X_LB.
[[nodiscard]] RigidTransform autorotation(const CondylarAxis& axis, double closing_deg);

/// Autorotation followed by the motion of a keyframe, whose center moves with the autorotation.
///
/// \param axis         from condylar_axis().
/// \param closing_deg  as for autorotation().
/// \param then         its center is given before the autorotation.
/// \returns the keyframe of both, with the same center and path fraction.
[[nodiscard]] geometry::Keyframe after_autorotation(const CondylarAxis& axis, double closing_deg,
                                                    const geometry::Keyframe& then);

/// The points of a mandible on and between its lower teeth.
///
/// \param mandible_L  its surface.
/// \param landmarks   with L1, L6-R and L6-L.
/// \returns its vertices above a plane 8 mm below L1 and the molars, and not more than 15 mm
///   behind the molars; or kPlanInvalid, naming the landmark, if one is missing, or if there are no
///   such points.
[[nodiscard]] Result<std::vector<Vec3>> points_of_lower_teeth(
    const geometry::TriangleMesh& mandible_L, std::span<const Landmark> landmarks);

/// A bone with which the lower teeth can meet.
struct UpperBone {
  geometry::Bvh surface_B;  ///< Closed; before it moves.
  RigidTransform X_LB = RigidTransform::Identity();
};

/// The angle of autorotation at which the lower teeth, closing from an open mouth, first come as
/// close to the upper jaw as a gap. The gap is that after the motion of a keyframe that follows the
/// autorotation, as in after_autorotation().
///
/// \param axis     of the mandible.
/// \param lower_L  points of the lower teeth.
/// \param upper    one or more bones at their planned poses.
/// \param gap_mm   >= 0.
/// \param then     the motion that follows; its center is given before the autorotation.
/// \returns the closing angle [degrees], exact to 0.001; or kPlanInvalid if the teeth are closer
///   than the gap at -20 degrees, or further away at 20 degrees.
/// \note Same bits for any number of threads.
[[nodiscard]] Result<double> closing_to_gap(const CondylarAxis& axis, std::span<const Vec3> lower_L,
                                            std::span<const UpperBone> upper, double gap_mm,
                                            const geometry::Keyframe& then = {});

}  // namespace lefort::plan
