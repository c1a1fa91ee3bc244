/// \file
/// How far points may move along a straight line without passing through a bone.
#pragma once

#include <lefort/contact/rigid_obstacle.h>
#include <lefort/core/types.h>

namespace lefort::contact {

/// Follows a point on a straight line (conservative advancement, \cite mirtich1996; sphere tracing,
/// \cite hart1996): a signed distance g changes by at most the distance moved, so that outside the
/// bone steps of length g skip nothing. Inside, where trial states of Newton's method may lie, the
/// line ends before the closest surface turns to the opposite side of the bone: where grad g has
/// turned by more than 120 degrees since the point entered, or since the start if that is inside.
/// From there the contact force would push the point out on the far side. At the edge of a bone
/// grad g turns by up to 90 degrees without a passage.
///
/// \param obstacle  the bone at its pose.
/// \param from_L    start of the line [mm].
/// \param step_L    end minus start [mm].
/// \returns the fraction of the line that is allowed, in (0, 1].
/// \note Parts thinner than half the resolution of the distance query may be missed.
[[nodiscard]] double allowed_fraction(const RigidObstacle& obstacle, const Vec3& from_L,
                                      const Vec3& step_L);

}  // namespace lefort::contact
