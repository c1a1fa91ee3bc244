/// \file
/// The adaptively sampled field of Frisken et al., one of the paper's two baselines: cells are
/// split from the largest down.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/field/build/prepare_surface.h>
#include <lefort/field/field_frame.h>
#include <lefort/field/sign/winding_scanlines.h>
#include <lefort/field/storage/octree.h>

namespace lefort::field {

/// Splits a cube, beginning with the whole domain, until trilinear interpolation between its
/// corners reproduces every point of the finest lattice in it within the tolerance, or it is one
/// cell \cite frisken2000. Cubes that the band does not reach are not split.
///
/// Distances are exact, one search of a box tree each; a lattice point is searched once however
/// many cubes ask for it.
///
/// \param winding  of the surface, or null if it is open.
/// \returns kCancelled.
[[nodiscard]] Result<Octree> split_top_down(const PreparedSurface& surface, const FieldFrame& frame,
                                            const WindingScanlines* winding, Progress& progress);

}  // namespace lefort::field
