/// \file
/// The tissue mesh in second order: tet10 with curved boundary.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/predict/separate_lips.h>
#include <lefort/predict/tissue_domain.h>

namespace lefort::predict {

/// Replaces linear elements by tet10: wedges and pyramids are split (mesh/split_into_tets.h), edges
/// get mid-edge nodes (mesh/elevate_order.h), and those of the boundary move to the surface of the
/// domain (mesh/fit_mid_edge_nodes.h). Edges at which the lips touch stay straight.
///
/// Lips are paired at mid-edge nodes, each with a third of the area of its faces; corners are not
/// paired. These areas are the integrals of the shape functions, zero at corners, so that a uniform
/// pressure acts without error.
///
/// \param linear    mesh of the domain with linear elements, regions and lips.
/// \param domain    its level is the surface.
/// \param progress  notes how many edges are curved.
/// \returns the mesh, or kMeshingFailed if a tetrahedron of a split element is flat or inverted.
[[nodiscard]] Result<TissueWithLips> second_order_tissue(TissueWithLips linear,
                                                         const TissueDomain& domain,
                                                         Progress& progress = Progress::none());

}  // namespace lefort::predict
