/// \file
/// Checks that a surface can be an arch.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/geometry/triangle_mesh.h>

#include <string>

namespace lefort::dental {

/// No arch is larger, with the base of a plaster cast.
inline constexpr double kMaxArch_mm = 150.0;

/// \param name      "upper" or "lower", for messages.
/// \param occlusal  unit vector from the arch to the other one.
/// \returns kInvalidArgument if the surface is unusable, larger than kMaxArch_mm, or its triangles
///   face inward: its vector area, or its volume if it is nearly closed, is negative.
[[nodiscard]] Result<void> check_arch(const geometry::TriangleMesh& arch, const std::string& name,
                                      const Vec3& occlusal);

/// Mean of the vertices. \pre there are some.
[[nodiscard]] Vec3 mean_vertex(const geometry::TriangleMesh& arch);

}  // namespace lefort::dental
