/// \file
/// Segments the CT table.
#pragma once

#include <lefort/anatomy/voxel_mask.h>

namespace lefort::anatomy {

/// A table and the thin blurred layer around it: the parts of `dense` with a constant cross-section
/// along the patient that are thin, at least 60 % as wide as the scan, and posterior to the mean of
/// the rest. Unlike other objects a table may touch the patient over a large area and be as dense
/// as the patient. Empty if there is no table, or the scan has fewer than 20 slices.
///
/// \param dense  voxels that are not air.
[[nodiscard]] Mask find_ct_table(const Mask& dense);

/// The axis of the grid, 0 to 2, that is closest to z of L.
[[nodiscard]] std::size_t long_axis(const image::Grid& grid);

}  // namespace lefort::anatomy
