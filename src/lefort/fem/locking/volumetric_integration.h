/// \file
/// Where an element takes the change of volume, so that it does not lock.
///
/// A law in split form (materials/decoupled_law.h) resists a change of volume a thousand times more
/// than one of shape. Asked at every integration point it would forbid elements nearly all motion:
/// they have too few freedoms for so many conditions. So the change of volume is averaged first,
///
///     W = sum over points of shear(F) dV + sum over means of U(mean of J) V ,
///
/// an energy like any other: its forces and tangent are its derivatives. It is the three-field
/// principle of Simo, Taylor and Pister with pressure and volume ratio taken out
/// (\cite simo1985; \cite bonet2008, section 8.6.5).
///
///     shape             mean of J                          means per node, away from the boundary
///     hex8              constant per element               1
///     tet10, wedge15    constant per element, but for a    0.7, 0.4
///                       part of U that stays at the points
///     hex20             linear in X per element            1 (4 per element)
///     tet4, wedge6,     over the elements around a node,   1
///       pyramid5        but for a part of U
///
/// Three freedoms per node stand against them. A constant per element would not do for the last
/// three: of tetrahedra there are five or six per node. Averaging around nodes is Bonet and
/// Burton's (\cite bonet1998), here around the inmost nodes of each element
/// (averaged_nodal_pressure.h). A part of U, kNodalStabilizationFraction times the shear modulus,
/// stays with the shear part, which keeps it stable (\cite gee2009). Wedge15 with a linear mean
/// locks, hex20 with a constant is worse.
///
/// One mean per tet10 or wedge15 does not see a change of volume that is linear in the element: a
/// single layer of them would bend far too easily. So a part of the bulk modulus,
/// kPointwiseBulkFraction times the shear modulus, stays at the points, as in selective reduced
/// integration, which takes lambda alone from them and leaves 2/3 of the shear modulus (\cite
/// malkus1978). Inside a body less stays here: so much that a block between sticking plates is as
/// right as without (tests/fem). Elements of a single layer keep more: so much that it bends as a
/// beam does within a tenth, of wedge15 a fifth where nu is close to 0.5 (docs/theory/locking.md, the
/// constants).
///
/// Tet4 and wedge6 bend too stiffly even where volume may change. So their shear part is taken at
/// means of F, around each edge and over each upright face (smoothed_strain_term.h), all but a
/// share kElementStabilizationFraction (\cite onishi2014 and \cite liu2009, there without it and
/// with faces in 2-D).
#pragma once

namespace lefort::fem {

/// Where laws in split form take the change of volume. Other laws always take it at the points.
enum class VolumetricIntegration {
  kMeanDilatation,  ///< As above.
  kFullIntegration  ///< At each integration point: locks; for comparison.
};

/// Of that shear part, what stays with the elements: without it nothing would keep a single one
/// from being crushed.
inline constexpr double kElementStabilizationFraction = 0.05;

}  // namespace lefort::fem
