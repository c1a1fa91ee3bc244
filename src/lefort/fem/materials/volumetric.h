/// \file
/// What a change of volume costs: the part U(J) of the laws in split form (decoupled_law.h).
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/fem/deformation.h>

namespace lefort::fem {

/// The shapes U may have, over kappa. All are 1/2 (J - 1)^2 to leading order; they differ where the
/// volume changes much.
enum class VolumetricForm {
  /// 1/2 (J - 1)^2. Finite at J = 0, so that nothing but the shear part keeps an element from being
  /// crushed. \cite bonet2008, section 6.5.
  kQuadratic,
  /// 1/4 (J^2 - 1 - 2 ln J). Convex, infinite at J = 0. \cite simo1991.
  kQuadraticLog,
  /// 1/2 (ln J)^2. Infinite at J = 0, but resists less and less beyond J = e. \cite simo1985.
  kLogSquared,
};

/// U(J), a function of J = det F alone. J > 0 everywhere below.
struct Volumetric {
  VolumetricForm form = VolumetricForm::kQuadratic;
  double kappa_mpa = 0.0;  ///< Bulk modulus at small strain, > 0.

  /// \returns kInvalidArgument if a constant lies outside its range.
  [[nodiscard]] Result<void> validate() const;

  /// U [MPa = mJ/mm^3]. Zero for J = 1.
  [[nodiscard]] double energy(double J) const { return energy_minus_one(J - 1.0); }

  /// U at J = 1 + change, for a change whose digits J would lose (jacobian_minus_one()).
  /// \note Right to a few units in the last place of `change`, however small.
  [[nodiscard]] double energy_minus_one(double change) const;

  /// dU/dJ [MPa], the hydrostatic part of the true stress; positive where J > 1.
  [[nodiscard]] double dU_dJ(double J) const;

  /// d2U/dJ2 [MPa].
  [[nodiscard]] double d2U_dJ2(double J) const;
};

}  // namespace lefort::fem
