/// \file
/// Quality of the elements of a mesh: scaled Jacobian of all shapes, further measures of
/// tetrahedra.
#pragma once

#include <lefort/core/types.h>
#include <lefort/mesh/volume_mesh.h>

#include <array>
#include <span>
#include <utility>
#include <vector>

namespace lefort::mesh {

/// Scaled Jacobian (\cite knupp2000): the volume spanned by the unit tangents of the three edges at
/// a corner, divided by that of the ideal element, minimum over the corners. Ideal elements are the
/// regular tetrahedron, the cube, the right wedge over an equilateral triangle, and the pyramid of
/// equilateral triangles over a square. For a pyramid, only the four corners of the base are used.
///
/// \param shape  of the element.
/// \param nodes  positions of the element's nodes, in their order.
/// \returns 1 for the ideal element, <= 0 if it is degenerate or inverted at a corner.
[[nodiscard]] double scaled_jacobian(ElementShape shape, std::span<const Vec3> nodes);

/// An element of low quality.
struct PoorElement {
  Index number = 0;  ///< Counted through all blocks, from 0.
  ElementShape shape = ElementShape::kTet4;
  Vec3 center_L = Vec3::Zero();  ///< Mean of its nodes [mm].
  double scaled_jacobian = 0.0;
};

/// \param mesh   elements of any shape.
/// \param limit  0 finds the elements that are degenerate or inverted at a corner.
/// \returns all elements with a scaled Jacobian of at most `limit`, in the order of the mesh.
[[nodiscard]] std::vector<PoorElement> poor_elements(const VolumeMesh& mesh, double limit);

/// Quality measures of one tetrahedron; all but the volume are independent of its size.
struct TetQuality {
  double volume_mm3;        ///< Negative if inverted.
  double min_dihedral_deg;  ///< Regular: arccos(1/3) = 70.53.
  double max_dihedral_deg;
  double scaled_jacobian;  ///< Minimum over the corners, 1 if regular, <= 0 if inverted.
  double radius_ratio;     ///< 3 inradius / circumradius: 1 if regular, <= 0 if inverted.
};

/// \param a, b, c, d  corners; the volume is positive if abc is counter-clockwise seen from d.
/// \returns all measures.
[[nodiscard]] TetQuality tet_quality(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// Dihedral angles of an element of linear shape, computed from the directions of the edges at its
/// corners, because bilinear faces have no single angle. For a pyramid the corners of the base are
/// used; every edge has an end at one of them. Regular wedge: 60 and 90; cube: 90.
///
/// \param shape  linear.
/// \param nodes  positions of the element's nodes, in their order.
/// \returns the smallest and the largest dihedral angle [degrees].
[[nodiscard]] std::array<double, 2> dihedral_range_deg(ElementShape shape,
                                                       std::span<const Vec3> nodes);

/// \param shape  of the element. A quadratic element is measured with straight edges; quadrilateral
///   faces are bilinear.
/// \param nodes  positions of the element's nodes, in their order.
/// \returns the volume [mm^3]; negative if the element is inverted.
[[nodiscard]] double volume_of(ElementShape shape, std::span<const Vec3> nodes);

/// Quality of a set of elements.
struct QualitySummary {
  Index elements = 0;
  double volume_mm3 = 0.0;
  double min_volume_mm3 = 0.0;
  double min_dihedral_deg = 0.0;
  double max_dihedral_deg = 0.0;
  double min_scaled_jacobian = 0.0;
  double mean_scaled_jacobian = 0.0;
  /// Elements by scaled Jacobian, 0.05 per bin, 0 to 1; negative values are in the first bin.
  std::array<Index, 20> jacobian_histogram{};
  /// Elements by smallest dihedral angle, ten degrees per bin, 0 to 90.
  std::array<Index, 9> dihedral_histogram{};
};

/// Quality of a whole mesh.
struct MeshQuality : QualitySummary {
  double min_radius_ratio = 0.0;   ///< Of the tetrahedra.
  double mean_radius_ratio = 0.0;  ///< Of the tetrahedra.
  /// Elements without positive volume or inverted at a corner, counted through all blocks.
  std::vector<Index> inverted;
  std::vector<std::pair<ElementShape, QualitySummary>> by_shape;  ///< Shapes that occur.
};

/// \param mesh  blocks of linear shapes and tet10. Dihedral angles, volumes and radius ratios of a
///   tet10 are those of the tetrahedron with straight edges.
/// \returns the quality of all elements.
[[nodiscard]] MeshQuality measure_quality(const VolumeMesh& mesh);

}  // namespace lefort::mesh
