/// \file
/// Assigns the regions muscle (by labels) and mucosa (by a rule) to elements of deep tissue, and
/// measures the regions.
#pragma once

#include <lefort/anatomy/label_map.h>
#include <lefort/mesh/region_sizes.h>
#include <lefort/mesh/volume_mesh.h>
#include <lefort/predict/prediction_options.h>

#include <string>
#include <vector>

namespace lefort::predict {

/// Assigns regions::kMuscle to elements of regions::kDeepTissue whose centroid lies in muscle:
/// where the mask of that label, interpolated between voxel centers, is at least one half. Other
/// regions, such as skin, stay.
///
/// \param tissue  mesh of the tissue.
/// \param labels  of the scan from which the tissue was meshed.
[[nodiscard]] mesh::VolumeMesh assign_muscle(mesh::VolumeMesh tissue,
                                             const anatomy::LabelMap& labels);

/// Assigns regions::kMucosa to elements of regions::kDeepTissue whose centroid lies within
/// `thickness_mm` of a voxel of airway or sinus. Other regions stay, such as muscle, and skin at
/// the nostrils.
///
/// \param tissue        mesh of the tissue.
/// \param labels        of the scan from which the tissue was meshed.
/// \param thickness_mm  > 0.
[[nodiscard]] mesh::VolumeMesh assign_mucosa(mesh::VolumeMesh tissue,
                                             const anatomy::LabelMap& labels, double thickness_mm);

/// A region of the mesh with its name.
struct RegionAndSize {
  std::string name;
  mesh::RegionSize size;
};

/// Sizes of the regions for which the options have a material; a region may be empty.
[[nodiscard]] std::vector<RegionAndSize> regions_and_sizes(const mesh::VolumeMesh& tissue,
                                                           const TissueOptions& options);

/// \returns a text such as "inside 79719 elements, 512.3 ml; muscle 1204 elements, 9.8 ml".
[[nodiscard]] std::string describe_regions(const mesh::VolumeMesh& tissue,
                                           const TissueOptions& options);

}  // namespace lefort::predict
