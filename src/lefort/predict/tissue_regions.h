/// \file
/// Checks and assigns the regions of tissue for which a plan has materials.
#pragma once

#include <lefort/anatomy/label_map.h>
#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/mesh/volume_mesh.h>
#include <lefort/predict/prediction_options.h>

namespace lefort::predict {

/// \param options  of the plan's tissue.
/// \param labels   of the scan.
/// \returns nothing, or kPlanInvalid: the plan has a material for muscle, but no voxel is muscle.
[[nodiscard]] Result<void> check_muscle_labels(const TissueOptions& options,
                                               const anatomy::LabelMap& labels);

/// Assigns muscle, then mucosa, if the options have materials for them: labels of muscle take
/// precedence over the rule that finds mucosa.
///
/// \param tissue    whose skin is assigned already.
/// \param options   of the plan's tissue.
/// \param labels    of the scan the tissue was meshed from.
/// \param progress  gets the size of each region, and a warning for each that is empty.
[[nodiscard]] mesh::VolumeMesh assign_tissue_regions(mesh::VolumeMesh tissue,
                                                     const TissueOptions& options,
                                                     const anatomy::LabelMap& labels,
                                                     Progress& progress);

}  // namespace lefort::predict
