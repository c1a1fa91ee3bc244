/// \file
/// Values and derivatives of the cubic B-spline whose coefficients spline_lattice.h finds.
#pragma once

#include <lefort/core/types.h>
#include <lefort/field/simd.h>
#include <lefort/field/sparse_lattice.h>

#include <span>

namespace lefort::field {

/// Value and derivatives with respect to lattice coordinates.
struct SplineValue {
  double value;
  Vec3 gradient;
  Mat3 hessian;
};

/// \param u       in lattice coordinates, within the cube of the lattice.
/// \param values  NaN in all members where a coefficient is missing. \pre as many as points.
/// \param simd    all give the same bits.
void evaluate_splines(const SparseLattice& coefficients, std::span<const Vec3> u,
                      std::span<SplineValue> values, Simd simd = best_simd());

/// The same for one point.
[[nodiscard]] SplineValue evaluate_spline(const SparseLattice& coefficients, const Vec3& u);

}  // namespace lefort::field
