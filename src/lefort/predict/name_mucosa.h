/// \file
/// Mucosa by rule: the tissue next to the air inside the patient.
#pragma once

#include <lefort/anatomy/label_map.h>
#include <lefort/mesh/volume_mesh.h>

namespace lefort::predict {

/// Gives elements of regions::kInside the region regions::kMucosa whose centroid lies within
/// `thickness_mm` of a voxel of airway or sinus. Skin, where the nostril begins, stays skin.
///
/// \param labels  of the scan the tissue was meshed from.
[[nodiscard]] mesh::VolumeMesh name_mucosa(mesh::VolumeMesh tissue, const anatomy::LabelMap& labels,
                                           double thickness_mm);

}  // namespace lefort::predict
