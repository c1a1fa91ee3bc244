/// \file
/// Reduces the streaks that metal causes in a CT scan.
#pragma once

#include <lefort/image/volume.h>

namespace lefort::anatomy {

/// A scan with fewer streaks.
struct StreakReduction {
  image::CtVolume ct;  ///< The scan itself if no slice has streaks.
  Index slices = 0;    ///< Number of changed slices.
};

/// Limits the CT numbers of slices with metal streaks to what the closest slices without streaks
/// make plausible.
///
/// Streaks lie in the plane in which a CT scanner measures, so the slices above and below the metal
/// show the same anatomy without them. A slice has streaks if neighboring voxels differ by more
/// than any tissue does within the resolution of a scanner. The CT number of each voxel is limited
/// to the range of the CT numbers within 3 mm in the two closest slices without streaks, one on
/// each side: their dilation and erosion (\cite serra1982). So bone, teeth, skin and air may lie up
/// to 3 mm beyond their position in those two, and a streak further away is removed. Bone that both
/// show remains bone, also where a streak is dark. Soft tissue may lie up to 8 mm beyond: lips,
/// nose and ears. Slices are not changed if the distance of those two exceeds 30 mm, or one of them
/// is missing.
///
/// The image domain is corrected because scans are stored without their projections, which the
/// interpolation of \cite kalender1987 needs.
///
/// \param ct       a scan; its slices are perpendicular to the axis of the grid closest to z of L.
/// \param bone_hu  threshold of bone.
/// \param skin_hu  threshold of the patient.
[[nodiscard]] StreakReduction reduce_metal_streaks(const image::CtVolume& ct, double bone_hu,
                                                   double skin_hu);

}  // namespace lefort::anatomy
