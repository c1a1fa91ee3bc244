/// \file
/// Whether faces and an obstacle passed through each other between two states, unseen at both.
#pragma once

#include <lefort/contact/rigid_obstacle.h>
#include <lefort/core/types.h>
#include <lefort/mesh/volume_mesh.h>

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lefort::solve {

/// Contact looks at states. An obstacle that lies before a body at one and behind it at the next
/// has touched nothing in between, and both are in balance. So the way of each face is looked at,
/// too: relative to the obstacle, straight from one state to the next. What begins clear of it may
/// not have been deeper in it on the way than it is at the end, by more than twice what its
/// detector resolves: an increment in which it slides that far round a bulge is too large as well.
class ContinuousContactCheck {
 public:
  /// \param nodes_L   all nodes at rest [mm].
  /// \param obstacle  its name, for sentences.
  ContinuousContactCheck(std::span<const Vec3> nodes_L, std::vector<mesh::Face> faces,
                         std::string obstacle);

  /// Begins the next way here.
  /// \param obstacle  as it lies.
  /// \param x_L       current positions of all nodes [mm].
  void commit(const contact::RigidObstacle& obstacle, std::span<const Vec3> x_L);

  /// \returns where a face went through the obstacle since commit() was last called, in words;
  ///   nothing if none did.
  [[nodiscard]] std::optional<std::string> rejection_reason(const contact::RigidObstacle& obstacle,
                                                            std::span<const Vec3> x_L) const;

 private:
  /// Nodes and middles of the faces, in the obstacle's frame [mm].
  [[nodiscard]] std::vector<Vec3> points_B(const contact::RigidObstacle& obstacle,
                                           std::span<const Vec3> x_L) const;

  std::string name_;  ///< Of the obstacle.
  std::vector<mesh::Face> faces_;
  std::vector<std::int32_t> nodes_;  ///< Of the faces, ascending.
  std::vector<Vec3> from_B_;
};

}  // namespace lefort::solve
