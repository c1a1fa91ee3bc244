/// \file
/// Ambient occlusion and soft shadow at the vertices of a surface.
///
/// Computed per visible vertex, not per pixel: it is smooth, and pictures of one scene share
/// it. The samples are a fixed pattern, rotated by a hash of the vertex number, so pictures are
/// reproducible.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/core/types.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/report/internal/ray_scene.h>

#include <cstdint>
#include <span>
#include <vector>

namespace lefort::report {

/// \returns area-weighted outward vertex normals, unit length; zero if a vertex has no triangle
///   with an area.
[[nodiscard]] std::vector<Vec3> vertex_normals(const geometry::TriangleMesh& mesh_L);

/// What a picture shows of a surface: only there light is computed.
struct LitRegion {
  std::vector<std::int32_t> vertices;    ///< Corners of visible triangles and their surroundings.
  std::vector<std::uint32_t> triangles;  ///< All with one of these vertices.
};

/// \param mesh_L   the surface.
/// \param visible  for each triangle, not zero if it is visible.
/// \returns the visible triangles, and as many rings around them as smoothing needs.
[[nodiscard]] LitRegion lit_region(const geometry::TriangleMesh& mesh_L,
                                   std::span<const char> visible);

/// A fraction at each vertex before smoothing, as far as it is computed.
struct VertexFractions {
  std::vector<float> values;   ///< 1 where not computed.
  std::vector<char> is_known;  ///< Not zero where computed.

  explicit VertexFractions(std::size_t vertices) : values(vertices, 1.0F), is_known(vertices, 0) {}
};

/// A surface with what casts shadows on it.
struct ShadedSurface {
  const geometry::TriangleMesh& mesh_L;
  const std::vector<Vec3>& normals_L;  ///< Of the vertices.
  const RayScene& obstacles;
};

/// \param surface          the surface.
/// \param region           where the result is valid.
/// \param max_distance_mm  largest distance of an occluder.
/// \param known            fractions of earlier pictures; receives the new ones.
/// \param progress         receives the fraction of vertices done; may request a stop.
/// \returns the cosine-weighted visible fraction of the hemisphere at each vertex, 0 to 1, valid at
///   the corners of visible triangles; or kCancelled.
[[nodiscard]] Result<std::vector<float>> ambient_occlusion(const ShadedSurface& surface,
                                                           const LitRegion& region,
                                                           double max_distance_mm,
                                                           VertexFractions& known,
                                                           Progress& progress);

/// \param surface      the surface.
/// \param region       where the result is valid.
/// \param key_light_L  direction of a disc-shaped lamp, unit length.
/// \param known        fractions of earlier pictures with this lamp; receives the new ones.
/// \param progress     receives the fraction of vertices done; may request a stop.
/// \returns the visible fraction of the lamp at each vertex, 0 to 1, valid at corners of visible
///   triangles; or kCancelled.
[[nodiscard]] Result<std::vector<float>> soft_shadow(const ShadedSurface& surface,
                                                     const LitRegion& region,
                                                     const Vec3& key_light_L,
                                                     VertexFractions& known, Progress& progress);

}  // namespace lefort::report
