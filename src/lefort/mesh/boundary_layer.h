/// \file
/// Covers part of a tetrahedral mesh's boundary with layers of wedges: skin over what is under it.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/mesh/convex_solid.h>
#include <lefort/mesh/volume_mesh.h>

#include <cstdint>
#include <span>

namespace lefort::mesh {

struct BoundaryLayerOptions {
  double thickness_mm = 1.5;         ///< Of all layers together, > 0.
  int layers = 2;                    ///< 1 to 8, equally thick.
  std::int32_t region = 1;           ///< Of the layers' elements.
  double min_scaled_jacobian = 0.1;  ///< Scaled; the layer gets thinner rather than fall below it.
};

/// Whether a face of the boundary belongs to a side where the mesh was cut off: one corner lies in
/// that plane, and the face is turned less than 45 degrees from it. So do faces that bevel the edge
/// between the side and other boundary, if they are turned more to the side.
[[nodiscard]] bool is_cut_face(std::span<const Vec3> nodes_L, const Face3& face,
                               const HalfSpace& side);

/// Moves the skin's nodes inwards by the thickness, the nodes below give way, and spans wedges
/// between where the skin was and where it is now. So the outer surface stays as it is, the volume
/// is shared out anew, and elements share whole faces.
///
///     outer   a-------b-------c-----r     Where the skin ends at other boundary, its last node r
///             | wedge | wedge | .'        stays single: a face with one such node carries
///     inner   a'------b'------c'          pyramids, with two tetrahedra. Where it ends at `sides`,
///              \ tet / \ tet / \          the wedges' own sides lie in them.
///
/// The layer is thinner where the body is thin (no more than a third of the way through it), where
/// its thickness would change by more than half of the distance, and where a tetrahedron would be
/// worse than options.min_scaled_jacobian, or an element of the layer than six tenths of that;
/// where less than a third would be left it is left out.
///
/// \param tets   one block of kTet4 with positive volumes, without sets.
/// \param skin   faces of its boundary.
/// \param sides  planes in which the mesh was cut off: nodes of faces there (is_cut_face) move
///   along them, or stay single if they lie beside them.
/// \returns the blocks: tetrahedra (those of the layer last), then pyramids and wedges if any;
///   nodes of `tets` keep their numbers, those of the skin are at the layer's bottom now. Or
///   - kInvalidArgument  an option lies outside its range;
///   - kMeshingFailed    an element came out flat or inside out;
///   - kCancelled        `progress` asked to stop.
/// \note Same input, same bits.
[[nodiscard]] Result<VolumeMesh> add_boundary_layer(const VolumeMesh& tets,
                                                    std::span<const Face> skin,
                                                    std::span<const HalfSpace> sides,
                                                    const BoundaryLayerOptions& options = {},
                                                    Progress& progress = Progress::none());

}  // namespace lefort::mesh
