/// \file
/// Continuous contact check: whether an obstacle passed through faces between two states.
#pragma once

#include <lefort/contact/rigid_obstacle.h>
#include <lefort/core/types.h>
#include <lefort/mesh/volume_mesh.h>

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lefort::solve {

/// Contact terms evaluate single states. If an obstacle is in front of a body in one state and
/// behind it in the next, it touches the body in neither state, and both states are in equilibrium.
/// This check follows each node and face center on a straight line, relative to the obstacle, from
/// one state to the next. For a point that starts outside the obstacle, the penetration on the way
/// must not exceed the penetration at the end by more than twice the resolution of the distance
/// query. The check also rejects an increment in which a point slides too far around a convex part
/// of the obstacle. Points that move by at most twice the resolution are not checked.
class ContinuousContactCheck {
 public:
  /// \param nodes_L   all nodes at rest [mm].
  /// \param faces     that the obstacle may touch.
  /// \param obstacle  its name, for messages.
  ContinuousContactCheck(std::span<const Vec3> nodes_L, std::vector<mesh::Face> faces,
                         std::string obstacle);

  /// Makes a state the start of the next check; to be called before the first check.
  /// \param obstacle  at its current pose.
  /// \param x_L       current positions of all nodes [mm].
  void commit(const contact::RigidObstacle& obstacle, std::span<const Vec3> x_L);

  /// \param obstacle  at its current pose.
  /// \param x_L       current positions of all nodes [mm].
  /// \returns a message with the position of a face that the obstacle passed through since
  ///   commit(); nothing if there is none.
  [[nodiscard]] std::optional<std::string> rejection_reason(const contact::RigidObstacle& obstacle,
                                                            std::span<const Vec3> x_L) const;

 private:
  /// Nodes and centers of the faces, in the obstacle's frame [mm].
  [[nodiscard]] std::vector<Vec3> points_B(const contact::RigidObstacle& obstacle,
                                           std::span<const Vec3> x_L) const;

  std::string name_;  ///< Of the obstacle.
  std::vector<mesh::Face> faces_;
  std::vector<std::int32_t> nodes_;  ///< Of the faces, ascending.
  std::vector<Vec3> from_B_;         ///< Points at commit().
};

}  // namespace lefort::solve
