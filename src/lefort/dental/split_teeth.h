/// \file
/// Divides the teeth of one jaw at their contacts.
#pragma once

#include <lefort/anatomy/voxel_mask.h>

#include <cstdint>

namespace lefort::dental {

/// Watershed of the distance to the surface, from maxima with a dynamic of `dynamic_mm` or more.
///
/// \param teeth       of one jaw.
/// \param dynamic_mm  how much narrower than the smaller part the passage between two parts is.
/// \returns the part of each voxel, from 1; 0 outside.
[[nodiscard]] image::Volume<std::int32_t> split_teeth(const anatomy::Mask& teeth,
                                                      double dynamic_mm);

}  // namespace lefort::dental
