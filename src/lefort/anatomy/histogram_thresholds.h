/// \file
/// Thresholds from the scan itself, for values that are no Hounsfield units or not quite.
#pragma once

#include <lefort/core/error.h>
#include <lefort/image/volume.h>

namespace lefort::anatomy {

/// The values that best part a scan into air, soft tissue and bone, and the means of the three.
struct HistogramThresholds {
  double skin_hu;  ///< Between air and soft tissue.
  double bone_hu;  ///< Between soft tissue and bone.
  double air_mean_hu;
  double soft_mean_hu;
  double bone_mean_hu;
};

/// Otsu's method for three classes: the two thresholds with the largest variance between classes.
/// \cite otsu1979
///
/// They follow any linear change of scale, and lie about half-way between the means: higher than
/// the usual 226 HU for bone, so that thin walls may be lost where the values are HU.
///
/// All voxels count, those of a table or head holder too.
///
/// \returns kAnatomyMissing if fewer than three values occur.
[[nodiscard]] Result<HistogramThresholds> find_thresholds(const image::CtVolume& ct);

}  // namespace lefort::anatomy
