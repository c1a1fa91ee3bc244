/// \file
/// Which nodes may move, and in which directions, while a boundary layer is made.
#pragma once

#include <lefort/core/types.h>
#include <lefort/mesh/convex_solid.h>
#include <lefort/mesh/internal/layer_surface.h>

#include <cstddef>
#include <span>
#include <vector>

namespace lefort::mesh::internal {

/// Max distance from a cut plane at which a node counts as lying in it [mm]: five times the default
/// TetOptions::level_tolerance_mm.
inline constexpr double kOnPlane_mm = 0.05;

/// \returns whether a point lies in a cut plane, within kOnPlane_mm.
[[nodiscard]] bool lies_on(const Vec3& p_L, const HalfSpace& plane);

/// Constraints on the displacements of the nodes of one mesh.
class LayerConstraints {
 public:
  /// \param surface     the covered faces.
  /// \param boundary    all boundary triangles of the mesh.
  /// \param cut_planes  planes by which the mesh was cut off: nodes of cut faces move within them.
  LayerConstraints(const LayerSurface& surface, std::span<const Face3> boundary,
                   std::span<const HalfSpace> cut_planes);

  /// \returns the part of `displacement` [mm] that lies in the cut planes at the node.
  [[nodiscard]] Vec3 project(std::size_t node, Vec3 displacement) const {
    for (const Vec3& n : blocked_[node]) displacement -= n.dot(displacement) * n;
    return displacement;
  }
  /// \returns at most three orthonormal directions in which the node must not move.
  [[nodiscard]] std::span<const Vec3> blocked_directions(std::size_t node) const {
    return blocked_[node];
  }
  /// \returns whether the layer ends at the node: the node has a boundary face that is neither
  ///   covered nor a cut face, or has a cut face and does not lie in its plane.
  [[nodiscard]] bool is_layer_boundary(std::size_t node) const {
    return is_layer_boundary_[node] != 0;
  }
  /// \returns whether the node's displacement is prescribed: it is covered, or is_layer_boundary.
  [[nodiscard]] bool is_fixed(std::size_t node) const { return is_fixed_[node] != 0; }

 private:
  std::vector<std::vector<Vec3>> blocked_;
  std::vector<char> is_layer_boundary_, is_fixed_;
};

}  // namespace lefort::mesh::internal
