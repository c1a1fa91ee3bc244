/// \file
/// Cubic convolution (\cite keys1981): a Catmull-Rom spline along each axis through the values of a
/// lattice, with slopes from central differences.
///
/// Continuously differentiable. At a cell face the second derivative across the face jumps by minus
/// the sum of the third differences on both sides; other second derivatives are continuous.
/// Quadratic polynomials are reproduced: for smooth values the error is of order cell^3, that of
/// second derivatives of order cell. Lattice values are interpolated exactly. Two C2 splines were
/// tried for contact: the interpolating one oscillates next to kinks of the distance, and the
/// smoothing one differs from the lattice values by 0.1 mm (99th percentile;
/// docs/studies/distance-query.md).
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

/// Evaluates the spline at several points.
///
/// \param lattice  its values.
/// \param u        points in lattice coordinates, inside the cube of the lattice.
/// \param values   results; all members are NaN if one of the 64 values around a point is missing.
///   \pre as many as points.
/// \param simd     instruction set; all give the same bits.
void evaluate_splines(const SparseLattice& lattice, std::span<const Vec3> u,
                      std::span<SplineValue> values, Simd simd = best_simd());

/// The same for one point.
[[nodiscard]] SplineValue evaluate_spline(const SparseLattice& lattice, const Vec3& u);

}  // namespace lefort::field
