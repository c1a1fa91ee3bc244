/// \file
/// Opens a slit in a mesh: elements on its two sides get separate nodes.
#pragma once

#include <lefort/core/types.h>
#include <lefort/mesh/volume_mesh.h>

#include <cstdint>
#include <functional>
#include <vector>

namespace lefort::mesh {

/// A smooth surface with a border.
struct SlitSurface {
  /// Signed distance to the surface [mm], exact to first order at zero; positive on its first side.
  std::function<double(const Vec3&)> level_set_L;
  /// Positive inside the border [mm]. Only there elements are separated.
  std::function<double(const Vec3&)> extent_L;
};

/// Two nodes at the same position, one on each side of a slit.
struct SlitPair {
  std::int32_t first = 0, second = 0;
  double area_mm2 = 0.0;  ///< Of the slit at the pair.
};

/// A mesh with a slit.
struct SlitMesh {
  VolumeMesh mesh;  ///< Nodes of the first side keep their numbers; those of the second are last.
  std::vector<Face> first_faces, second_faces;  ///< Of elements on each side.
  std::vector<SlitPair> pairs;   ///< Ascending. Border nodes inside the body are not duplicated.
  double area_mm2 = 0.0;         ///< Of one side.
  double rms_distance_mm = 0.0;  ///< Of the nodes of the slit from the surface.
};

/// Separates the elements on one side of a surface from those on the other.
///
/// The side of an element is that of its centroid. If more of its faces adjoin elements of the
/// other side than of its own, the element changes its side. Nodes between the sides move onto the
/// surface as far as the scaled Jacobians of their elements permit. Boundary nodes move along the
/// boundary; those on its ridges (a face deviates by more than 40 degrees from the normal of the
/// node) and nodes of elements other than kTet4 do not move. Then each node is duplicated whose
/// elements the slit separates. No element is removed. A part of less than a hundredth of the
/// elements is not separated.
///
/// \param mesh         linear elements, without sets.
/// \param surface      of the slit; its functions are called by one thread.
/// \param is_inside_L  the body. After each move a boundary node is snapped to the surface of the
///   body, which must lie within 0.5 mm; otherwise the move is shortened or omitted.
/// \returns the mesh; unchanged, without faces, if the surface separates no elements.
[[nodiscard]] SlitMesh open_slit(VolumeMesh mesh, const SlitSurface& surface,
                                 const std::function<bool(const Vec3&)>& is_inside_L);

}  // namespace lefort::mesh
