/// \file
/// A scan and its labels, made of closed surfaces of skin and bone: for cases without a CT.
#pragma once

#include <lefort/anatomy/label_map.h>
#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/image/volume.h>

#include <optional>

namespace lefort::anatomy {

/// Closed surfaces of one head, in L.
struct HeadSurfaces {
  geometry::TriangleMesh skin_L;
  geometry::TriangleMesh skull_L;
  std::optional<geometry::TriangleMesh> mandible_L{};
};

/// CT numbers and labels on one grid.
struct LabeledScan {
  image::CtVolume ct;
  LabelMap labels;
};

/// Voxelizes a head. Near a surface CT numbers are linear in the distance to it, so that the
/// iso-surfaces at the default thresholds (226 and -300 HU) lie on the surfaces. The CT numbers
/// reach that of soft tissue, 40 HU, half a voxel from a surface; that of air, -1000 HU, about one
/// voxel outside the skin; and that of bone, 1200 HU, 2.6 voxels inside the bone. The mandible
/// takes precedence over the skull, bone over soft tissue. The brain is found as in a scan; airway
/// and sinuses are unknown and count as soft tissue.
///
/// At a flat end of the skin normal to an axis of L (400 mm^2 or more, where a scan was truncated)
/// the grid ends two voxels inside the skin, so that the result is truncated there, too.
///
/// \param surfaces  closed; orientation is corrected.
/// \param voxel_mm  edge of a voxel, > 0.
/// \param progress  receives the fraction done; may request a stop.
/// \returns scan and labels, or
///   - kInvalidArgument  the voxel size is not positive, or the grid has more than 5e8 voxels;
///   - kMeshInvalid      a surface is empty, open (the message names it and an edge) or not finite;
///   - kAnatomyMissing   no bone lies inside the grid around the skin;
///   - kCancelled        `progress` requested a stop.
[[nodiscard]] Result<LabeledScan> scan_from_surfaces(const HeadSurfaces& surfaces, double voxel_mm,
                                                     Progress& progress = Progress::none());

}  // namespace lefort::anatomy
