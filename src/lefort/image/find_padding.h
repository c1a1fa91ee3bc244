/// \file
/// Finds padding: voxels outside the circular field of view, which a scanner fills with one value.
#pragma once

#include <lefort/image/volume.h>

#include <cstdint>

namespace lefort::image {

/// Padding voxels of a volume.
struct Padding {
  std::int16_t hu = 0;    ///< CT number of padding voxels [HU].
  double fraction = 0.0;  ///< Fraction of voxels that are padding, 0 to 1.
  /// Area where padding borders on tissue, summed over faces normal to the axes.
  double truncated_mm2 = 0.0;
};

/// Finds voxels of one constant value that extend inward from the faces of the grid, line by line.
///
/// At the skin CT numbers decrease to air over a few voxels. Where padding borders directly on
/// tissue, the field of view truncates the patient, and what looks like skin is not skin.
///
/// \param ct         the scan.
/// \param tissue_hu  voxels of at least this CT number are patient [HU].
/// \returns the padding, with the value of the first voxel of the middle slice; its fraction is 0
///   if this voxel is patient.
[[nodiscard]] Padding find_padding(const CtVolume& ct, double tissue_hu);

}  // namespace lefort::image
