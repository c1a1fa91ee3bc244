/// \file
/// Volumes of the tissues in a scan.
#pragma once

#include <lefort/anatomy/label_map.h>
#include <lefort/geometry/triangle_mesh.h>

#include <string>
#include <utility>
#include <vector>

namespace lefort::anatomy {

/// Name and volume [ml] of each tissue except the background, in the order of kTissueStyles.
[[nodiscard]] std::vector<std::pair<std::string, double>> tissue_volumes_ml(const LabelMap& labels);

/// Volumes of the two labels of bone.
struct BoneVolumes {
  double skull_ml = 0.0;
  double mandible_ml = 0.0;
};

/// Labeled bone inside a surface, estimated at the centers of every n-th voxel along each axis;
/// n is chosen so that about 2e5 voxels or fewer in the box of the surface are visited.
///
/// \param labels     any grid.
/// \param surface_L  closed, of any orientation; empty encloses nothing.
[[nodiscard]] BoneVolumes bone_volumes_within(const LabelMap& labels,
                                              const geometry::TriangleMesh& surface_L);

}  // namespace lefort::anatomy
