/// \file
/// Continuous contact check: whether a rigid body passed through faces between two states.
#pragma once

#include <lefort/contact/rigid_obstacle.h>
#include <lefort/core/types.h>
#include <lefort/mesh/volume_mesh.h>

#include <optional>
#include <span>

namespace lefort::contact {

/// Contact terms evaluate single states. If a body is in front of tissue in one state and behind it
/// in the next, it touches the tissue in neither state, and both states are in equilibrium. This
/// check follows each node and face center on a straight line, relative to the body, from one state
/// to the next. For a point that starts outside the body, the penetration on the way must not
/// exceed the penetration at the end by more than twice the resolution of the distance query. The
/// check also finds points that slide too far around a convex part of the body. Points that move by
/// at most twice the resolution are not checked.
/// \param obstacle   at its pose in the second state.
/// \param faces      that the body may touch.
/// \param from_X_LB  pose of the body in the first state.
/// \param from_L     positions of all nodes in the first state [mm].
/// \param to_L       positions of all nodes in the second state [mm].
/// \returns the final position of a point of a face that the body passed through [mm]; nothing if
///   there is none.
[[nodiscard]] std::optional<Vec3> find_passage(const RigidObstacle& obstacle,
                                               std::span<const mesh::Face> faces,
                                               const RigidTransform& from_X_LB,
                                               std::span<const Vec3> from_L,
                                               std::span<const Vec3> to_L);

}  // namespace lefort::contact
