/// \file
/// Distance of a point to voxels of one tissue.
#pragma once

#include <lefort/anatomy/label_map.h>
#include <lefort/core/types.h>

namespace lefort::predict {

/// \param labels     of the scan.
/// \param tissue     whose voxels count.
/// \param p_L        a point.
/// \param within_mm  search radius.
/// \returns the distance to the closest voxel of `tissue` within the radius [mm]; infinity if there
///   is none.
[[nodiscard]] double distance_to_label(const anatomy::LabelMap& labels, anatomy::Tissue tissue,
                                       const Vec3& p_L, double within_mm);

}  // namespace lefort::predict
