/// \file
/// Which second derivative of the energy Newton steps by.
#pragma once

namespace lefort::fem {

enum class Tangent {
  /// d2W/dx2: quadratic convergence near a minimum, but may be indefinite.
  kExact,
  /// Every contribution whose negative eigenvalues can be removed is projected to a positive
  /// semidefinite one (Teran et al. 2005). Unlike a diagonal shift this slows only the nodes
  /// concerned.
  kPsdProjected,
  /// The antisymmetric part of the derivative of forces that have no energy; the exact tangent is
  /// the symmetric part.
  kAntisymmetric
};

}  // namespace lefort::fem
