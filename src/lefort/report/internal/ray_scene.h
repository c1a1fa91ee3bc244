/// \file
/// Ray casting with Embree. In this layer, only this class uses Embree.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/geometry/triangle_mesh.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

namespace lefort::report {

struct RayHit {
  double distance_mm;
  Vec3 normal_L;           ///< Of the flat triangle, outward, unit length.
  std::uint32_t triangle;  ///< In the mesh that was hit; not meaningful with several meshes.
  double u, v;             ///< Barycentric weights of the second and third corner.
};

/// A search tree over the triangles of some meshes.
class RayScene {
 public:
  /// \param meshes  the vertices of every triangle exist; coordinates are finite, within +-1e9 mm.
  /// \returns the scene, or kInvalidArgument if Embree cannot start or memory is exhausted.
  [[nodiscard]] static Result<RayScene> build(
      std::span<const geometry::TriangleMesh* const> meshes);

  /// \returns the closest hit along `direction_L` (unit length), nothing if there is none.
  [[nodiscard]] std::optional<RayHit> closest(const Vec3& origin_L, const Vec3& direction_L) const;

  /// \returns whether there is a hit within `max_distance_mm` along `direction_L` (unit length).
  [[nodiscard]] bool blocked(const Vec3& origin_L, const Vec3& direction_L,
                             double max_distance_mm) const;

 private:
  explicit RayScene(std::shared_ptr<void> scene) : scene_(std::move(scene)) {}
  std::shared_ptr<void> scene_;  ///< An RTCScene, which owns its device.
};

}  // namespace lefort::report
