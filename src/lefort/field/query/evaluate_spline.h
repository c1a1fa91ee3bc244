/// \file
/// Cubic convolution (\cite keys1981): the piecewise cubic of Catmull and Rom along each axis,
/// through the values of a lattice, with the slopes of central differences.
///
/// Continuously differentiable. At a cell face the second derivative across it jumps, by the sum of
/// the third differences on both sides; no other does. Reproduces quadratic polynomials: where the
/// values are smooth the error is of order cell^3, that of the second derivatives of order cell.
/// Every value is kept. Of the splines that were tried for contact the C2 one through the values
/// swings beside kinks of the distance, and the C2 one that smooths them tells depths wrong there,
/// by 0.1 mm at P99 (docs/theory/contact.md).
#pragma once

#include <lefort/core/types.h>
#include <lefort/field/simd.h>
#include <lefort/field/storage/sparse_lattice.h>

#include <span>

namespace lefort::field {

/// Value and derivatives with respect to lattice coordinates.
struct SplineValue {
  double value;
  Vec3 gradient;
  Mat3 hessian;
};

/// \param u       in lattice coordinates, within the cube of the lattice.
/// \param values  NaN in all members where one of the 64 around a point is missing. \pre as many
///   as points.
/// \param simd    all give the same bits.
void evaluate_splines(const SparseLattice& lattice, std::span<const Vec3> u,
                      std::span<SplineValue> values, Simd simd = best_simd());

/// The same for one point.
[[nodiscard]] SplineValue evaluate_spline(const SparseLattice& lattice, const Vec3& u);

}  // namespace lefort::field
