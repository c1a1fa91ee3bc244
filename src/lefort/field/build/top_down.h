/// \file
/// The adaptively sampled field of Frisken et al., one of the paper's two baselines: an octree
/// refined top-down.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/field/build/prepare_surface.h>
#include <lefort/field/field_frame.h>
#include <lefort/field/sign/winding_scanlines.h>
#include <lefort/field/storage/octree.h>

namespace lefort::field {

/// Splits a cube, beginning with the whole domain, until trilinear interpolation from its corners
/// reproduces the distance at every point of the finest lattice in the cube within the tolerance,
/// or the cube is one cell \cite frisken2000. Cubes without a point of the band are not split.
///
/// Distances are exact; each takes one query of a bounding volume hierarchy. Within a cube of 16
/// cells per edge, which one thread refines, each lattice point is computed once.
///
/// \param surface   to be sampled.
/// \param frame     lattice of the field.
/// \param winding   of the surface, or null if it is open.
/// \param progress  receives the fraction done; may cancel.
/// \returns the octree, or kCancelled.
[[nodiscard]] Result<Octree> split_top_down(const PreparedSurface& surface, const FieldFrame& frame,
                                            const WindingScanlines* winding, Progress& progress);

}  // namespace lefort::field
