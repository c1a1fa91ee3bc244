/// \file
/// Contact in thin bone.
///
/// The normal of the closest surface does not always point out of thin bone the right way. Beyond
/// the medial surface of a plate the closest surface is the far side. In a ridge it is one of the
/// flanks, while the tissue must leave over the tip. Each point therefore stores the closest point
/// and the normal of the last accepted state in which it had not crossed the medial surface
/// (contact reference). Once it has crossed, the tangent plane of that state is its constraint. The
/// half-space behind a plane has no edges, and its potential is convex.
///
///        tangent plane - - - - ___ - - - -     reference: closest point and normal at the tip
///                             / o \            o: closest are the flanks, in alternation
#pragma once

#include <lefort/contact/measure_gap.h>
#include <lefort/core/types.h>

namespace lefort::contact {

/// Closest point of the bone and its normal, in the frame of the bone.
struct ContactReference {
  Vec3 foot_B = Vec3::Zero();    ///< Closest point of the surface [mm].
  Vec3 normal_B = Vec3::Zero();  ///< Outward unit normal there; zero beyond the band.
  bool is_side_known = false;    ///< The zone of the point was known.

  [[nodiscard]] bool has_tangent_plane() const { return normal_B.squaredNorm() > 0.0; }
};

/// \param obstacle  the bone at its present pose.
/// \param p_L       the point [mm].
/// \param gap       measure_gap() of p_L.
/// \returns the contact reference of the point.
[[nodiscard]] ContactReference contact_reference(const RigidObstacle& obstacle, const Vec3& p_L,
                                                 const Gap& gap);

/// \param last  \pre last.has_tangent_plane().
/// \returns the gap of p_L to the plane through `foot_B` with normal `normal_B`.
[[nodiscard]] Gap gap_to_tangent_plane(const RigidObstacle& obstacle, const Vec3& p_L,
                                       const ContactReference& last);

/// \param gap   measure_gap() of p_L.
/// \param last  contact reference of the point.
/// \returns whether the point lies in the bone, the closest normal differs by more than 60 degrees
///   from the reference normal, and the tangent plane is further away than the closest surface. The
///   last condition excludes concave corners, where the closest surface is the right constraint.
[[nodiscard]] bool has_crossed_medial_surface(const RigidObstacle& obstacle, const Vec3& p_L,
                                              const Gap& gap, const ContactReference& last);

/// \param gap   measure_gap() of p_L.
/// \param last  contact reference of the point.
/// \returns whether a point that had crossed the medial surface has returned, by one of these:
///   - it is beyond the band,
///   - it is outside the bone, and the closest normal is within 120 degrees of the reference
///     normal,
///   - the closest normal is within about 45 degrees of the reference normal,
///   - the tangent plane is not further away than the closest surface.
///   45 degrees instead of the 60 of has_crossed_medial_surface() give a hysteresis.
[[nodiscard]] bool has_returned(const RigidObstacle& obstacle, const Vec3& p_L, const Gap& gap,
                                const ContactReference& last);

/// \param gap   measure_gap() of a point.
/// \param last  contact reference of the point.
/// \returns whether the point lies in the bone and the closest normal differs by more than 120
///   degrees from the reference normal. Outside the bone such a change is no tunneling: where a
///   point crosses a groove, the closest surface changes from one wall to the other.
[[nodiscard]] bool is_at_far_side(const RigidObstacle& obstacle, const Gap& gap,
                                  const ContactReference& last);

}  // namespace lefort::contact
