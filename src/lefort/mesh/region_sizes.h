/// \file
/// How large the regions of a mesh are.
#pragma once

#include <lefort/core/types.h>
#include <lefort/mesh/volume_mesh.h>

#include <cstdint>
#include <map>

namespace lefort::mesh {

struct RegionSize {
  Index elements = 0;
  double volume_mm3 = 0.0;
};

/// By the numbers of the regions that occur.
///
/// \pre Every block is of a linear shape.
[[nodiscard]] std::map<std::int32_t, RegionSize> region_sizes(const VolumeMesh& mesh);

}  // namespace lefort::mesh
