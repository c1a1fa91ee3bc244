/// \file
/// Rest gap of tissue points: the gap to the obstacle at which a point begins to be in contact.
#pragma once

#include <lefort/contact/measure_gap.h>
#include <lefort/contact/rigid_obstacle.h>
#include <lefort/core/types.h>

namespace lefort::contact {

/// Gap of a point to the bone itself, which the obstacle may replace (RigidObstacle::bone_B).
///
/// \param to_obstacle  of the same point.
[[nodiscard]] Gap gap_to_bone(const RigidObstacle& obstacle, const Vec3& p_L,
                              const Gap& to_obstacle);

/// Rest gap to the bone itself.
///
/// \param to_bone          G in the reference configuration.
/// \param contact_snap_mm  >= 0.
/// \returns G_0 = G - c [mm], with c as in rest_gap_mm(); 0 beyond the range of the query if
///   positive.
[[nodiscard]] double bone_rest_gap_mm(const Gap& to_bone, double contact_snap_mm);

/// A patch at rest is in equilibrium, but the faces of the mesh differ from the surface of the bone
/// by their chord height, and the obstacle may differ from the bone. A point is therefore in
/// contact when the obstacle has come closer by the clearance
///
///   c = max(G, 0),  but 0 if |G| <= contact_snap_mm,
///
/// where G is the gap to the bone in the reference configuration: g_0 = g - c.
///
/// \param to_obstacle      g in the reference configuration.
/// \param to_bone          G.
/// \param contact_snap_mm  >= 0.
/// \returns g_0 [mm]; 0 if g or G is beyond the range of its query and positive.
[[nodiscard]] double rest_gap_mm(const Gap& to_obstacle, const Gap& to_bone,
                                 double contact_snap_mm);

/// Penetration increase into the bone itself.
///
/// \param to_obstacle       of the same point.
/// \param bone_rest_gap_mm  of bone_rest_gap_mm().
/// \returns G_0 - G [mm]; 0 beyond the range of the query outside the bone.
[[nodiscard]] double bone_depth_mm(const RigidObstacle& obstacle, const Vec3& p_L,
                                   const Gap& to_obstacle, double bone_rest_gap_mm);

}  // namespace lefort::contact
