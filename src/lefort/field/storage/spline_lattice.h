/// \file
/// The lattice values for the spline of DistanceField::sample_smooth() (evaluate_spline.h).
///
/// They are not reconstructed from the octree: coalesced cells have the octree's tolerance as
/// noise, which second differences divide by cell^2, and contact stiffness would contain that
/// noise. Besides, a query would take up to 64 traversals of the octree instead of at most eight
/// brick lookups.
#pragma once

#include <lefort/core/types.h>
#include <lefort/field/storage/sparse_lattice.h>

namespace lefort::field {

/// The values near a surface, without those in conflict.
///
/// \param values         of the band.
/// \param cell           spacing of the lattice; also the max difference between neighbors of a
///   distance field. Larger differences are sign conflicts beyond the boundary of an open surface:
///   both values become NaN.
/// \param max_magnitude  bricks without a value of at most this magnitude are dropped.
[[nodiscard]] SparseLattice spline_lattice(const SparseLattice& values, double cell,
                                           double max_magnitude);

}  // namespace lefort::field
