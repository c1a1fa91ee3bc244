/// \file
/// Curves the boundary of a second-order mesh: mid-edge nodes move to the surface of the body.
#pragma once

#include <lefort/core/types.h>
#include <lefort/mesh/elevate_order.h>
#include <lefort/mesh/find_zero_crossing.h>

#include <functional>
#include <span>
#include <vector>

namespace lefort::mesh {

/// The surface that the boundary of a mesh approximates.
struct CurvedSurface {
  InsidePredicate is_inside_L;  ///< The body, without regard to its planes.
  /// Unit normals of the planes through a point, where the body is cut off; parallel or
  /// perpendicular to each other. Mid-edge nodes stay in these planes.
  std::function<std::vector<Vec3>(const Vec3&)> planes_at_L;
};

/// A mesh with curved edges.
struct CurvedMesh {
  QuadraticMesh quadratic;
  Index curved = 0;        ///< Edges whose mid-edge node is on the surface.
  Index limited = 0;       ///< Edges that det J limits to half or a quarter of the way, or to none.
  double max_mm = 0.0;     ///< Largest displacement of a mid-edge node.
  double min_ratio = 1.0;  ///< Min of (det J / det J with straight edges), see kMinJacobianRatio.
};

/// Smallest admissible det J (J: derivative of the position by the reference coordinates) of a
/// curved element at its nodes and quadrature points, divided by that of the element with straight
/// edges.
inline constexpr double kMinJacobianRatio = 0.2;

/// Moves each mid-edge node of the boundary along the boundary normal to where `is_inside_L`
/// changes. A node does not move if that is further away than a quarter of the length of its edge.
/// Where det J of an element would be less than kMinJacobianRatio times its value with straight
/// edges, the mid-edge nodes of the element move half of the way, a quarter of it, or not at all
/// (\cite luo2004 for the criterion).
///
/// \param quadratic  one block of tet10 with straight edges and positive volumes.
/// \param surface    its functions are called by one thread.
/// \param straight   boundary faces whose edges stay straight, such as the sides of a slit.
/// \returns the mesh; corners have not moved.
[[nodiscard]] CurvedMesh fit_mid_edge_nodes(QuadraticMesh quadratic, const CurvedSurface& surface,
                                            std::span<const Face> straight = {});

}  // namespace lefort::mesh
