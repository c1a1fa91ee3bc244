/// \file
/// Element count and volume of the regions of a mesh.
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

/// \param mesh  every block is of a linear shape.
/// \returns the sizes by region number, for the regions that occur.
[[nodiscard]] std::map<std::int32_t, RegionSize> region_sizes(const VolumeMesh& mesh);

}  // namespace lefort::mesh
