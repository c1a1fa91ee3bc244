/// \file
/// Integration of the volumetric energy so that elements do not lock.
///
/// The bulk modulus of a decoupled law (materials/decoupled_law.h) of nearly incompressible tissue
/// is usually hundreds of times its shear modulus. With full integration there are more volume
/// constraints than the degrees of freedom can satisfy: the elements lock. Therefore J is averaged
/// first:
///
///     W = sum over points of Psi_iso(F) dV + sum over averages of U(J_mean) V
///
/// Forces and tangent are the derivatives of this energy. The energy follows from the three-field
/// principle of Simo, Taylor and Pister by elimination of pressure and dilatation (\cite simo1985;
/// \cite bonet2008, section 8.6.5).
///
///     shape                     pressure                           inf-sup stable
///
///     tet10, wedge15, hex20     continuous, at the corner nodes    yes
///     hex8                      constant per element               no
///     tet4, wedge6, pyramid5    none: U at the points; they lock   -
///
/// The first row is the Taylor-Hood pair (\cite taylor1973; \cite boffi2013, chapter 8), with
/// the pressure eliminated by nodal quadrature (nodal_pressure.h). It carries the term of lambda;
/// the bulk modulus 2/3 mu stays at the points (volumetric_split.h). `lefort verify --only inf-sup`
/// measures the inf-sup numbers. The method has no tuned constants.
#pragma once

#include <lefort/fem/elements/all_elements.h>

namespace lefort::fem {

/// Integration of U in decoupled laws. Other laws always have full integration.
enum class VolumetricIntegration {
  kMeanDilatation,  ///< With averages as above.
  kFullIntegration  ///< At each integration point; locks; for comparison.
};

/// Where J is averaged.
enum class VolumeAverage {
  kNone,         ///< Nowhere: U at the points.
  kElement,      ///< One mean per element.
  kCornerNodes,  ///< One mean per corner node, over the elements around it; lone_corners.h.
};

template <class Element>
inline constexpr VolumeAverage kVolumeAverage = VolumeAverage::kNone;
template <>
inline constexpr VolumeAverage kVolumeAverage<Hex8> = VolumeAverage::kElement;
template <>
inline constexpr VolumeAverage kVolumeAverage<Tet10> = VolumeAverage::kCornerNodes;
template <>
inline constexpr VolumeAverage kVolumeAverage<Wedge15> = VolumeAverage::kCornerNodes;
template <>
inline constexpr VolumeAverage kVolumeAverage<Hex20> = VolumeAverage::kCornerNodes;

}  // namespace lefort::fem
