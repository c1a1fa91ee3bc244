/// \file
/// Kinds of the tangent stiffness.
#pragma once

namespace lefort::fem {

/// Kind of the tangent stiffness.
enum class Tangent {
  /// d2W/dx2: gives quadratic convergence near a minimum, but may be indefinite.
  kExact,
  /// The exact tangent without parts that are indefinite far from equilibrium: of contact, of
  /// supports that follow a surface, of averaged pressures and of follower pressures. (Teran et al.
  /// 2005 project element matrices; here they stay exact, so that this tangent may be indefinite.)
  /// Unlike a diagonal shift, the omission affects only the nodes of these terms.
  kStabilized,
  /// The antisymmetric part of the derivative of forces without a potential. For these forces
  /// kExact means the symmetric part.
  kAntisymmetric
};

}  // namespace lefort::fem
