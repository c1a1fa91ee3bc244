/// \file
/// The constant value a scanner writes where it saw nothing, around its round field of view.
#pragma once

#include <lefort/image/volume.h>

#include <cstdint>

namespace lefort::image {

/// What surrounds the field of view within the grid.
struct Padding {
  std::int16_t hu = 0;    ///< The value.
  double fraction = 0.0;  ///< Of all voxels.
  double cut_mm2 = 0.0;   ///< Area over which it borders on tissue, as seen along the axes.
};

/// Finds voxels of one constant value that reach in from the faces of the grid, line by line.
///
/// Air ends in a ramp of half air, half tissue. Where padding borders on tissue without one, the
/// field of view cuts the patient off, and what looks like skin is none.
///
/// \param tissue_hu  from here on a voxel is the patient.
/// \returns the padding with the value of the first voxel of the middle slice; nothing is padded if
///   its share is 0.
[[nodiscard]] Padding find_padding(const CtVolume& ct, double tissue_hu);

}  // namespace lefort::image
