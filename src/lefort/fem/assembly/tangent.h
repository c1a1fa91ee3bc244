/// \file
/// Which second derivative of the energy Newton steps by.
#pragma once

namespace lefort::fem {

enum class Tangent {
  kExact,         ///< d2W/dx2: quadratic convergence near a minimum, but may be indefinite.
  kPsdProjected,  ///< Each term that can leaves out what is negative in it. Unlike a shift this slows
                  ///< only the nodes concerned.
  kAntisymmetric  ///< What the derivative of forces without an energy has beside its symmetric
                  ///< part, which is the exact tangent.
};

}  // namespace lefort::fem
