/// \file
/// How much light from all around, and from one lamp, reaches each vertex of a surface.
///
/// Computed per vertex, not per pixel: smooth without noise, and what does not depend on the view
/// is computed once for all views. The samples are a fixed pattern, turned by a hash of the vertex
/// number, so pictures are the same in every run.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/core/types.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/report/internal/ray_scene.h>

#include <vector>

namespace lefort::report {

/// Outward, unit length, the triangles around a vertex weighted by their area; zero where a vertex
/// has no triangle with an area.
[[nodiscard]] std::vector<Vec3> vertex_normals(const geometry::TriangleMesh& mesh_L);

/// The share of the sky over each vertex that nothing within `reach_mm` hides, cosine-weighted
/// (ambient occlusion), 0 to 1. kCancelled.
[[nodiscard]] Result<std::vector<float>> ambient_occlusion(const geometry::TriangleMesh& mesh_L,
                                                           const std::vector<Vec3>& normals_L,
                                                           const RayScene& obstacles,
                                                           double reach_mm, Progress& progress);

/// The share of a round soft lamp in direction `key_light_L` (unit length) that each vertex sees, 0
/// to
/// 1. kCancelled.
[[nodiscard]] Result<std::vector<float>> soft_shadow(const geometry::TriangleMesh& mesh_L,
                                                     const std::vector<Vec3>& normals_L,
                                                     const RayScene& obstacles,
                                                     const Vec3& key_light_L, Progress& progress);

}  // namespace lefort::report
