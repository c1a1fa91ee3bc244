/// \file
/// Surfaces in the format of the page: LFSURF1 (contract/openapi.json).
#pragma once

#include <lefort/core/types.h>
#include <lefort/geometry/triangle_mesh.h>

#include <span>
#include <string>
#include <vector>

namespace lefort::server {

/// \param mesh_L   vertices in frame L [mm].
/// \param scalars  arrays with one number per vertex.
[[nodiscard]] std::string encode_surface(const geometry::TriangleMesh& mesh_L,
                                         std::span<const std::vector<double>> scalars = {});

/// float32 x, y, z of each.
[[nodiscard]] std::string encode_floats(std::span<const Vec3> vectors);

/// float32 of each.
[[nodiscard]] std::string encode_floats(std::span<const double> numbers);

}  // namespace lefort::server
