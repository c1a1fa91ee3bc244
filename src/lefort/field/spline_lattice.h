/// \file
/// A twice continuously differentiable function over lattice values: the cubic B-spline behind
/// DistanceField::sample_smooth, evaluated by evaluate_spline.h.
///
/// Why a lattice beside the octree: values rebuilt from coalesced cells carry the octree's
/// tolerance as noise, and second differences divide it by cell^2. On a ball of 20 mm with cells of
/// 0.36 mm the root mean square error of the Hessian is 0.0015 /mm from this lattice, whatever the
/// tolerance, and from the octree 0.060 /mm at a tolerance of 0.02 mm, the first to unite cells
/// there: as large as the curvature itself (0.071 /mm). Contact stiffness would inherit that. A
/// query would also cost up to 64 descents instead of at most eight brick look-ups.
#pragma once

#include <lefort/core/types.h>
#include <lefort/field/sparse_lattice.h>

namespace lefort::field {

/// Turns lattice values f into B-spline coefficients c = f - (second differences of f) / 6.
///
/// With these the spline equals f up to order cell^4 where f is smooth (it reproduces cubic
/// polynomials); without the correction it would shift a surface of mean curvature H by
/// cell^2 H / 3 towards its concave side. Interpolating coefficients were tried: the spline then
/// swings beside kinks of the distance, and contact takes a third more Newton iterations
/// (docs/contact.md).
///
/// \param cell   spacing of the lattice; also the largest difference between neighbours of a
///   distance field. Larger ones are tears of the sign behind the rim of an open surface: the
///   points on both sides of a tear, and those without all neighbours, get no coefficient (NaN).
/// \param reach  only bricks holding a value of at most this size are kept.
[[nodiscard]] SparseLattice spline_coefficients(const SparseLattice& values, double cell,
                                                double reach);

}  // namespace lefort::field
