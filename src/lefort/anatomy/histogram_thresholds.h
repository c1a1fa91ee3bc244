/// \file
/// Thresholds from the histogram of a scan, for values that are not exactly Hounsfield units.
#pragma once

#include <lefort/core/error.h>
#include <lefort/image/volume.h>

namespace lefort::anatomy {

/// Thresholds that divide a scan into air, soft tissue and bone, and the means of the three
/// classes.
struct HistogramThresholds {
  double skin_hu;  ///< Between air and soft tissue.
  double bone_hu;  ///< Between soft tissue and bone.
  double air_mean_hu;
  double soft_mean_hu;
  double bone_mean_hu;
};

/// Otsu's method for three classes: the two thresholds with the largest between-class variance
/// \cite otsu1979.
///
/// They follow a linear change of the scale of values. They lie about halfway between the means:
/// for bone above the usual 226 HU, so that thin walls may be lost if the values are HU. All voxels
/// count, including those of a table or head holder.
///
/// \param ct  the scan.
/// \returns kAnatomyMissing if there are too few different values for three classes.
[[nodiscard]] Result<HistogramThresholds> find_thresholds(const image::CtVolume& ct);

}  // namespace lefort::anatomy
