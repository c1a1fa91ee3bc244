/// \file
/// The lattice values for the spline of DistanceField::sample_smooth() (evaluate_spline.h).
///
/// They are not reconstructed from the octree. Merged cells have errors up to the octree's
/// tolerance. Second differences divide these errors by cell^2, and the contact stiffness would
/// contain them. A query would also take up to 64 traversals of the octree instead of at most eight
/// brick lookups.
#pragma once

#include <lefort/core/types.h>
#include <lefort/field/storage/sparse_lattice.h>

namespace lefort::field {

/// The values near a surface, without those in conflict.
///
/// \param values         of the band.
/// \param cell           spacing of the lattice [mm]; also the max difference between neighbors of
///   a distance field. Larger differences are sign conflicts, for example beyond the boundary of an
///   open surface: both values become NaN.
/// \param max_magnitude  a brick is kept if one of its values has at most this magnitude [mm].
[[nodiscard]] SparseLattice spline_lattice(const SparseLattice& values, double cell,
                                           double max_magnitude);

}  // namespace lefort::field
