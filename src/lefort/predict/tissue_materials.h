/// \file
/// What the regions of the tissue's mesh are made of.
#pragma once

#include <lefort/core/error.h>
#include <lefort/fem/materials/material.h>
#include <lefort/predict/prediction_options.h>

namespace lefort::predict {

/// \returns a law for each of the regions that mesh_tissue.h names and the options have; or
///   kInvalidArgument for constants out of range.
[[nodiscard]] Result<fem::RegionMaterials> materials_of(const TissueOptions& tissue);

}  // namespace lefort::predict
