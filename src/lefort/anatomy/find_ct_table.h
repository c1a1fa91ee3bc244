/// \file
/// The table a patient lies on.
#pragma once

#include <lefort/anatomy/voxel_mask.h>

namespace lefort::anatomy {

/// The parts of `dense`, what is not air, that look the same all along the patient and lie behind
/// all else: a table, and a thin layer around it. Unlike other foreign things it may touch the
/// patient broadly, and is as dense. Empty if there is none.
[[nodiscard]] Mask find_ct_table(const Mask& dense);

/// The axis, 0 to 2, that runs along the patient.
[[nodiscard]] std::size_t long_axis(const image::Grid& grid);

}  // namespace lefort::anatomy
