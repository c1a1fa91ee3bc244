/// \file
/// How well shaped the elements of a mesh are: scaled Jacobians of all shapes, and of tetrahedra
/// more.
#pragma once

#include <lefort/core/types.h>
#include <lefort/mesh/volume_mesh.h>

#include <array>
#include <span>
#include <utility>
#include <vector>

namespace lefort::mesh {

/// The volume spanned by the directions of the three edges at a corner, smallest over the corners
/// (\cite knupp2000): 1 for the ideal element (regular tetrahedron, cube, right wedge over an
/// equilateral triangle, pyramid of equilateral triangles over a square), <= 0 if it is flat or
/// inside out somewhere. The directions of curved edges are those at the corner itself.
///
/// Of a pyramid the four corners of the base count: what is there reaches up to the apex.
///
/// \param nodes  positions of the element's nodes, in their order.
[[nodiscard]] double scaled_jacobian(ElementShape shape, std::span<const Vec3> nodes);

/// An element, and how to find it.
struct PoorElement {
  Index number = 0;  ///< Counted through the blocks, from 0.
  ElementShape shape = ElementShape::kTet4;
  Vec3 center_L = Vec3::Zero();  ///< Mean of its nodes [mm].
  double scaled_jacobian = 0.0;
};

/// All elements with a scaled Jacobian of at most `limit`, in the order of the mesh; with 0, those
/// that are flat or inside out at a corner.
[[nodiscard]] std::vector<PoorElement> poor_elements(const VolumeMesh& mesh, double limit);

/// Measures of one tetrahedron; all lengths cancel but in the volume.
struct TetQuality {
  double volume_mm3;        ///< Negative if inverted.
  double min_dihedral_deg;  ///< Regular: arccos(1/3) = 70.53.
  double max_dihedral_deg;
  double scaled_jacobian;  ///< Smallest over the corners, 1 if regular, <= 0 if inverted.
  double radius_ratio;     ///< 3 inradius / circumradius, 1 if regular, 0 if flat.
};

/// The measures of the tetrahedron a, b, c, d; positive volume if d lies on the side of abc from
/// which abc is counter-clockwise.
[[nodiscard]] TetQuality tet_quality(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// The smallest and the largest dihedral angle [degrees] of an element of linear shape: those
/// between the directions of the edges at its corners, as curved faces have no other. Of a pyramid
/// the corners of the base count, which every edge has. Regular wedge: 60 and 90; cube: 90.
///
/// \param nodes  positions of the element's nodes, in their order.
[[nodiscard]] std::array<double, 2> dihedral_range_deg(ElementShape shape,
                                                       std::span<const Vec3> nodes);

/// The volume of an element of linear shape [mm^3], its quadrilaterals being bilinear; negative if
/// it is inverted.
[[nodiscard]] double volume_of(ElementShape shape, std::span<const Vec3> nodes);

/// The measures of some elements.
struct QualitySummary {
  Index elements = 0;
  double volume_mm3 = 0.0;
  double min_volume_mm3 = 0.0;
  double min_dihedral_deg = 0.0;
  double max_dihedral_deg = 0.0;
  double min_scaled_jacobian = 0.0;
  double mean_scaled_jacobian = 0.0;
  /// Elements by scaled Jacobian, 0.05 per bin, 0 to 1; those below in the first.
  std::array<Index, 20> jacobian_histogram{};
  /// Elements by smallest dihedral angle, ten degrees per bin, 0 to 90.
  std::array<Index, 9> dihedral_histogram{};
};

/// The measures of a whole mesh.
struct MeshQuality : QualitySummary {
  double min_radius_ratio = 0.0;  ///< Of the tetrahedra; so is the mean.
  double mean_radius_ratio = 0.0;
  /// Elements without positive volume or inside out at a corner, counted through the blocks.
  std::vector<Index> inverted;
  std::vector<std::pair<ElementShape, QualitySummary>> by_shape;  ///< Of those that occur.
};

/// \pre Every block is of a linear shape.
[[nodiscard]] MeshQuality measure_quality(const VolumeMesh& mesh);

}  // namespace lefort::mesh
