/// \file
/// Random points near a surface, at which benchmarks query distances.
#pragma once

#include <lefort/core/types.h>
#include <lefort/geometry/triangle_mesh.h>

#include <cstdint>
#include <vector>

namespace lefort::bench {

/// Points distributed uniformly over the surface, then displaced by random vectors that are
/// distributed uniformly in the ball of radius `max_distance_mm`. The same seed gives the same
/// points.
[[nodiscard]] std::vector<Vec3> points_near_surface(const geometry::TriangleMesh& mesh, Index count,
                                                    double max_distance_mm, std::uint32_t seed);

}  // namespace lefort::bench
