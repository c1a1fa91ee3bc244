/// \file
/// The lattice values that DistanceField::sample_smooth lays a spline through (evaluate_spline.h).
///
/// Why a lattice beside the octree: values rebuilt from coalesced cells carry the octree's
/// tolerance as noise, and second differences divide it by cell^2. Contact stiffness would inherit
/// that. A query would also cost up to 64 descents instead of at most eight brick look-ups.
#pragma once

#include <lefort/core/types.h>
#include <lefort/field/storage/sparse_lattice.h>

namespace lefort::field {

/// The values near a surface, but those beside a tear.
///
/// \param cell   spacing of the lattice; also the largest difference between neighbors of a
///   distance field. Larger ones are tears of the sign behind the rim of an open surface: the
///   points on both sides of a tear become NaN.
/// \param reach  only bricks holding a value of at most this size are kept.
[[nodiscard]] SparseLattice spline_lattice(const SparseLattice& values, double cell, double reach);

}  // namespace lefort::field
