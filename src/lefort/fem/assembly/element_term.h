/// \file
/// The elements of a volume mesh as force terms: their strain energy.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/fem/assembly/force_term.h>
#include <lefort/fem/locking/volumetric_integration.h>
#include <lefort/fem/materials/material.h>
#include <lefort/mesh/volume_mesh.h>

#include <memory>
#include <vector>

namespace lefort::fem {

/// One term per non-empty block of `mesh`, and one for all nodal pressures, if any. Total
/// Lagrangian: gradients are computed once, in the reference configuration mesh.nodes_L.
///
/// \param mesh                    elements of any shapes; adjacent blocks should have matching
///   faces.
/// \param materials               one for every region that occurs.
/// \param volumetric_integration  of decoupled laws.
/// \returns the terms, which do not refer to `mesh` afterwards, or
///   - kElementInverted  the reference Jacobian of an element is not positive at a quadrature
///     point or at a node; the message has the number and the center of the element;
///   - kMeshInvalid      a node number, coordinate or list length is wrong, or there is no element;
///   - kInvalidArgument  a region has no material, or a constant of a material lies outside its
///     range.
/// \note Elements are numbered through the blocks, from 0.
[[nodiscard]] Result<std::vector<std::unique_ptr<const ForceTerm>>> make_element_terms(
    const mesh::VolumeMesh& mesh, const RegionMaterials& materials,
    VolumetricIntegration volumetric_integration = VolumetricIntegration::kMeanDilatation);

}  // namespace lefort::fem
