/// \file
/// The elements of a volume mesh as force terms: the energy their deformation stores.
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

/// One term per non-empty block of `mesh`, and one for the change of volume that is averaged around
/// nodes, if any; total Lagrangian: gradients are taken once, in the reference configuration
/// mesh.nodes_L.
///
/// \param mesh        elements of any shapes; where blocks meet their faces should be the same.
/// \param materials   one for every region that occurs.
/// \param dilatation  where laws in split form take the change of volume; the others do not care.
/// \returns the terms, which do not refer to `mesh` any more, or
///   - kElementInverted  an element has no positive reference volume at an integration point or a
///     node; number and place are told;
///   - kMeshInvalid      a node number, coordinate or list length is wrong, or there is no element;
///   - kInvalidArgument  a region has no material, or a constant of a material lies outside its
///     range.
/// \note An element's number counts through the blocks, from 0.
[[nodiscard]] Result<std::vector<std::unique_ptr<const ForceTerm>>> make_element_terms(
    const mesh::VolumeMesh& mesh, const RegionMaterials& materials,
    VolumetricIntegration volumetric_integration = VolumetricIntegration::kMeanDilatation);

}  // namespace lefort::fem
