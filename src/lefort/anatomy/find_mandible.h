/// \file
/// Segments the mandible.
#pragma once

#include <lefort/anatomy/voxel_mask.h>

namespace lefort::anatomy {

/// The mandible with its teeth and marrow; empty if the scan does not contain it, or if it cannot
/// be separated from the skull.
///
/// A component of bone that has the size and the position of a mandible is the mandible. Else a
/// marker-controlled watershed (\cite vincent1991) separates it. Markers are the body of the
/// mandible, which is the largest wide component below the occlusal plane (find_occlusal_planes.h),
/// and three parts of the skull: the maxilla above the plane, what lies above the joints, and what
/// lies behind them. The markers keep 5 mm from the plane. Mandible and skull grow from their
/// markers, thick bone first, so that they meet at the narrowest cross-sections: in the joints and
/// at the occlusion. The thickness is that of dense bone and of the marrow that it encloses; voxels
/// of the joint space are less dense and do not count. The result is one component of 10 to 150 ml,
/// smaller than the rest of bone.
///
/// \param ct       the scan.
/// \param bone     all bone, including marrow. \pre on the grid of `ct`.
/// \param bone_hu  threshold of bone.
[[nodiscard]] Mask find_mandible(const image::CtVolume& ct, const Mask& bone, double bone_hu);

}  // namespace lefort::anatomy
