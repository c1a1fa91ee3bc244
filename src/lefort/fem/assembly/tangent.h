/// \file
/// Kinds of the tangent stiffness.
#pragma once

namespace lefort::fem {

/// Kind of the tangent stiffness.
enum class Tangent {
  /// d2W/dx2: gives quadratic convergence near a minimum, but may be indefinite.
  kExact,
  /// Contributions with negative eigenvalues are projected to positive semidefinite ones where that
  /// is possible (Teran et al. 2005). Unlike a diagonal shift this affects only the nodes
  /// concerned.
  kPsdProjected,
  /// The antisymmetric part of the derivative of forces without a potential; their exact tangent is
  /// the symmetric part.
  kAntisymmetric
};

}  // namespace lefort::fem
