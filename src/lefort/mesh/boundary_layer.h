/// \file
/// Covers part of the boundary of a tetrahedral mesh with layers of wedges.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/mesh/convex_solid.h>
#include <lefort/mesh/volume_mesh.h>

#include <cstdint>
#include <span>

namespace lefort::mesh {

struct BoundaryLayerOptions {
  double thickness_mm = 1.5;         ///< Of all layers together, > 0, < 1000.
  int layers = 2;                    ///< 1 to 8, equally thick.
  std::int32_t region = 1;           ///< Region of the layer's elements.
  double min_scaled_jacobian = 0.1;  ///< 0 to 0.5; where quality is lower, the layer is thinner.
};

/// Whether a boundary face belongs to a plane at which the meshed region ends: at least one corner
/// lies in the plane (within 0.05 mm), and the outward normals of face and half-space differ by
/// less than 45 degrees. A bevel face between the plane and other boundary therefore belongs to the
/// plane if its normal is closer to that of the plane.
///
/// \param nodes_L  nodes of the mesh [mm].
/// \param face     corners, counter-clockwise seen from outside.
/// \param plane    the mesh lies inside this half-space.
/// \returns true for a cut face.
[[nodiscard]] bool is_cut_face(std::span<const Vec3> nodes_L, const Face3& face,
                               const HalfSpace& plane);

/// Moves the nodes of the skin inwards by the thickness, displaces the interior nodes harmonically,
/// and fills the gap between the initial and the moved skin with wedges. The outer surface does not
/// change, and elements are joined by whole faces. Boundary layers of this kind are described by
/// \cite garimella2000; here interior nodes move instead of being remeshed.
///
///     outer   a-------b-------c-----r     Where the skin ends at other boundary, its last node r
///             | wedge | wedge | .'        is not doubled: pyramids lie under faces with one such
///     inner   a'------b'------c'          node, tetrahedra under faces with two. Where the skin
///              \ tet / \ tet / \          ends at a cut plane, sides of the wedges lie in it.
///
/// The layer is thinner
/// - where the body is thin: at most a third of the distance through it;
/// - where the thickness would change by more than half of the distance between nodes;
/// - where the scaled Jacobian of a tetrahedron would fall below options.min_scaled_jacobian and
///   below 0.9 of its initial value, or that of an element of the layer below 0.6
///   min_scaled_jacobian.
/// It is omitted where less than a third of the thickness would be left.
///
/// \param tets        one block of kTet4 with positive volumes, without sets.
/// \param skin        faces of its boundary to be covered.
/// \param cut_planes  planes at which the meshed region ends. Skin nodes of cut faces (is_cut_face)
///   move within their plane; those that do not lie in it are not doubled.
/// \param options     thickness and quality.
/// \param progress    receives the fraction of thinning rounds done; may request a stop.
/// \returns the blocks: tetrahedra (those of the layer last), then pyramids and wedges if any;
///   nodes of `tets` keep their numbers, those of the skin are at the bottom of the layer. Or
///   - kInvalidArgument  an option lies outside its range;
///   - kMeshingFailed    an element has no volume or is inverted, or the layer still gets thinner
///     after 30 rounds;
///   - kCancelled        `progress` requested a stop.
/// \note Same input, same bits.
[[nodiscard]] Result<VolumeMesh> add_boundary_layer(const VolumeMesh& tets,
                                                    std::span<const Face> skin,
                                                    std::span<const HalfSpace> cut_planes,
                                                    const BoundaryLayerOptions& options = {},
                                                    Progress& progress = Progress::none());

}  // namespace lefort::mesh
