/// \file
/// Isochoric part of F and its strain; stress and tangent, with respect to F, of laws that are
/// functions of the isochoric part.
///
/// \cite bonet2008, "Distortional component of the deformation gradient" and section 6.5;
/// \cite holzapfel2000, section 6.4.
#pragma once

#include <lefort/core/types.h>
#include <lefort/fem/deformation.h>

namespace lefort::fem {

/// F_iso = J^(-1/3) F, so that det F_iso = 1.
struct IsochoricPart {
  /// \pre det F > 0.
  explicit IsochoricPart(const Mat3& F);

  double scale = 1.0;  ///< J^(-1/3).
  Mat3 F_iso;
  Mat3 F_inv_T;
};

/// \param part  of F.
/// \param dpsi  dpsi/dF_iso.
/// \returns dPsi/dF of Psi(F) = psi(F_iso).
[[nodiscard]] Mat3 isochoric_stress(const IsochoricPart& part, const Mat3& dpsi);

/// \param part   of F.
/// \param dpsi   dpsi/dF_iso.
/// \param ddpsi  d2psi/dF_iso2.
/// \returns d2Psi/dF2 of Psi(F) = psi(F_iso).
[[nodiscard]] Mat9 isochoric_tangent(const IsochoricPart& part, const Mat3& dpsi,
                                     const Mat9& ddpsi);

/// Isochoric strain in quantities that are zero if the shape does not change:
///   J^(-2/3) C = (1 + I1_minus_3 / 3) (I + D),   tr D = 0.
/// They are computed without cancellation, so that they are accurate at any strain.
struct IsochoricStrain {
  /// \pre det F > 0.
  explicit IsochoricStrain(const Mat3& F);

  /// J^(-2/3) C - I, twice the Green strain of F_iso.
  [[nodiscard]] Mat3 twice_strain() const {
    const double third = I1_minus_3 / 3.0;
    return third * Mat3::Identity() + (1.0 + third) * D;
  }

  Mat3 D;                   ///< dev C / (tr C / 3).
  double I1_minus_3 = 0.0;  ///< J^(-2/3) I1 - 3, >= 0.
  double I2_minus_3 = 0.0;  ///< J^(-4/3) I2 - 3, >= 0.
};

}  // namespace lefort::fem
