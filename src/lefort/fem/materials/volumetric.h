/// \file
/// Volumetric energy U(J) of decoupled laws (decoupled_law.h).
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/fem/deformation.h>

namespace lefort::fem {

/// U / kappa. All forms are 1/2 (J - 1)^2 to leading order; they differ at large changes of volume.
enum class VolumetricForm {
  /// 1/2 (J - 1)^2. Finite at J = 0: only the isochoric energy keeps an element from inverting.
  /// \cite bonet2008, section 6.5.
  kQuadratic,
  /// 1/4 (J^2 - 1 - 2 ln J). Convex, infinite at J = 0. \cite simo1991.
  kQuadraticLog,
  /// 1/2 (ln J)^2. Infinite at J = 0; softens beyond J = e. \cite simo1985.
  kLogSquared,
};

/// U(J). Every function requires J > 0.
struct Volumetric {
  VolumetricForm form = VolumetricForm::kQuadratic;
  double kappa_mpa = 0.0;  ///< Bulk modulus at small strain, > 0.

  /// \returns kInvalidArgument if a constant lies outside its range.
  [[nodiscard]] Result<void> validate() const;

  /// U [MPa = mJ/mm^3]. Zero for J = 1.
  [[nodiscard]] double energy(double J) const { return energy_minus_one(J - 1.0); }

  /// \param change  J - 1, from jacobian_minus_one().
  /// \returns U at J = 1 + change, with a relative error of a few units in the last place.
  [[nodiscard]] double energy_minus_one(double change) const;

  /// dU/dJ [MPa], the hydrostatic part of the Cauchy stress; positive for J > 1.
  [[nodiscard]] double dU_dJ(double J) const;

  /// d2U/dJ2 [MPa].
  [[nodiscard]] double d2U_dJ2(double J) const;
};

}  // namespace lefort::fem
