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
///     shape             average of J                       averages per interior node
///
///     hex8              constant per element               1
///     tet10, wedge15    constant per element; a part of    0.7, 0.4
///                       U stays at the points
///     hex20             linear in X per element            1 (4 per element)
///     tet4, wedge6,     over the elements around a node;   1
///       pyramid5        a part of U stays in the elements
///
/// A node has three degrees of freedom; too many averages per node lock.
///
/// **tet4, wedge6, pyramid5.** A mesh has five or six tetrahedra per node, so that a constant per
/// element would lock. J is averaged around nodes (\cite bonet1998), here around the innermost
/// nodes of each element (averaged_nodal_pressure.h). The part of U with the bulk modulus
/// kNodalStabilizationFactor times the shear modulus stays in the elements for stability
/// (\cite gee2009).
///
/// **tet10, wedge15.** One average per element does not resist a change of volume that is linear in
/// the element: a single layer would bend far too easily. The part of U with the bulk modulus
/// kPointwiseBulkFactor times the shear modulus therefore stays at the points. (Selective reduced
/// integration, \cite malkus1978, averages only the term of lambda, which leaves a bulk modulus of
/// 2/3 of the shear modulus at the points.) In parts more than one layer thick the factor is
/// smaller, because it must not make a compressed block stiffer
/// (tests/fem/test_compressed_block.cpp). In a single layer it is larger: the stiffness in bending
/// is then that of a beam within 10 %, for wedge15 near nu = 0.5 within 20 %
/// (docs/theory/locking.md). Wedge15 with a linear average locks. Hex20 with a constant average is
/// less accurate.
///
/// **tet4 and wedge6 in bending.** They are too stiff even for compressible laws. Their strain
/// energy is evaluated at averages of F over smoothing domains (smoothed_strain_term.h), except for
/// the fraction kElementStabilizationFraction (\cite onishi2014; \cite liu2009, there in 2-D and
/// without that fraction).
#pragma once

namespace lefort::fem {

/// Integration of U in decoupled laws. Other laws always have full integration.
enum class VolumetricIntegration {
  kMeanDilatation,  ///< With averages as above.
  kFullIntegration  ///< At each integration point; locks; for comparison.
};

/// Fraction of the strain energy of tet4 and wedge6 that is evaluated in the elements. Without it
/// one element of a mesh could invert without resistance, while the averages with its neighbors
/// stay admissible. docs/studies/locking-remedies.md compares values.
inline constexpr double kElementStabilizationFraction = 0.05;

}  // namespace lefort::fem
