/// \file
/// Which of the tissue inside is mucosa, by rule, and which muscle, by the labels; and how much of
/// the mesh each region is.
#pragma once

#include <lefort/anatomy/label_map.h>
#include <lefort/mesh/region_sizes.h>
#include <lefort/mesh/volume_mesh.h>
#include <lefort/predict/prediction_options.h>

#include <string>
#include <vector>

namespace lefort::predict {

/// Gives elements of regions::kInside the region regions::kMuscle whose centroid lies in voxels
/// labeled muscle: where these, interpolated between voxel centers, make up half at least. What
/// was named before, such as skin, stays.
///
/// \param labels  of the scan the tissue was meshed from.
[[nodiscard]] mesh::VolumeMesh assign_muscle(mesh::VolumeMesh tissue,
                                             const anatomy::LabelMap& labels);

/// Gives elements of regions::kInside the region regions::kMucosa whose centroid lies within
/// `thickness_mm` of a voxel of airway or sinus. What was named before stays: skin, where the
/// nostril begins, and muscle.
///
/// \param labels  of the scan the tissue was meshed from.
[[nodiscard]] mesh::VolumeMesh assign_mucosa(mesh::VolumeMesh tissue,
                                             const anatomy::LabelMap& labels, double thickness_mm);

/// A region of the mesh, by name.
struct RegionAndSize {
  std::string name;
  mesh::RegionSize size;
};

/// Of the regions that the options have a material for; a region may be empty.
[[nodiscard]] std::vector<RegionAndSize> regions_and_sizes(const mesh::VolumeMesh& tissue,
                                                           const TissueOptions& options);

/// "inside 79719 elements, 512.3 ml; muscle 1204 elements, 9.8 ml"
[[nodiscard]] std::string describe_regions(const mesh::VolumeMesh& tissue,
                                           const TissueOptions& options);

}  // namespace lefort::predict
