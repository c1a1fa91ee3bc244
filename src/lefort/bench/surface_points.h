/// \file
/// Where benchmarks ask for distances.
#pragma once

#include <lefort/core/types.h>
#include <lefort/geometry/triangle_mesh.h>

#include <cstdint>
#include <vector>

namespace lefort::bench {

/// Points spread evenly over the surface, then moved in a random direction by up to `reach_mm`.
/// The same for the same seed.
[[nodiscard]] std::vector<Vec3> points_near_surface(const geometry::TriangleMesh& mesh, Index count,
                                                    double reach_mm, std::uint32_t seed);

}  // namespace lefort::bench
