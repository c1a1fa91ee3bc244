/// \file
/// Segments the CT table.
#pragma once

#include <lefort/anatomy/voxel_mask.h>

namespace lefort::anatomy {

/// The parts of `dense` with a constant cross-section along the patient that lie posterior to
/// everything else: a table and the thin blurred layer around it. Unlike other objects a table may
/// touch the patient over a large area and be equally dense. Empty if there is no table.
///
/// \param dense  voxels that are not air.
[[nodiscard]] Mask find_ct_table(const Mask& dense);

/// The axis of the grid, 0 to 2, that is closest to z of L.
[[nodiscard]] std::size_t long_axis(const image::Grid& grid);

}  // namespace lefort::anatomy
