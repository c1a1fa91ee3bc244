/// \file
/// Materials of the regions of the tissue mesh.
#pragma once

#include <lefort/core/error.h>
#include <lefort/fem/materials/material.h>
#include <lefort/predict/prediction_options.h>

namespace lefort::predict {

/// \param tissue  constants of the materials.
/// \returns a law for each region of mesh_tissue.h that has constants; or kInvalidArgument for
///   constants out of range.
[[nodiscard]] Result<fem::RegionMaterials> materials_of(const TissueOptions& tissue);

}  // namespace lefort::predict
