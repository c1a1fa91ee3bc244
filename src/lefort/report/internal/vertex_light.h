/// \file
/// Ambient occlusion and soft shadow at the vertices of a surface.
///
/// Computed per vertex, not per pixel: the result is smooth, and the part that does not depend on
/// the view is computed once. The samples are a fixed pattern, rotated by a hash of the vertex
/// number, so pictures are reproducible.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/core/types.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/report/internal/ray_scene.h>

#include <vector>

namespace lefort::report {

/// \returns area-weighted outward vertex normals, unit length; zero if a vertex has no triangle
///   with an area.
[[nodiscard]] std::vector<Vec3> vertex_normals(const geometry::TriangleMesh& mesh_L);

/// \param mesh_L           the surface.
/// \param normals_L        of its vertices.
/// \param obstacles        what occludes.
/// \param max_distance_mm  largest distance of an occluder.
/// \param progress         receives the fraction of vertices done; may request a stop.
/// \returns the cosine-weighted visible fraction of the hemisphere at each vertex, 0 to 1; or
///   kCancelled.
[[nodiscard]] Result<std::vector<float>> ambient_occlusion(const geometry::TriangleMesh& mesh_L,
                                                           const std::vector<Vec3>& normals_L,
                                                           const RayScene& obstacles,
                                                           double max_distance_mm,
                                                           Progress& progress);

/// \param mesh_L       the surface.
/// \param normals_L    of its vertices.
/// \param obstacles    what casts shadows.
/// \param key_light_L  direction of a disc-shaped lamp, unit length.
/// \param progress     receives the fraction of vertices done; may request a stop.
/// \returns the visible fraction of the lamp at each vertex, 0 to 1; or kCancelled.
[[nodiscard]] Result<std::vector<float>> soft_shadow(const geometry::TriangleMesh& mesh_L,
                                                     const std::vector<Vec3>& normals_L,
                                                     const RayScene& obstacles,
                                                     const Vec3& key_light_L, Progress& progress);

}  // namespace lefort::report
