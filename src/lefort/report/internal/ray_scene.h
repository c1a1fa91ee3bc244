/// \file
/// Ray casting with Embree. In this layer, only this class uses Embree.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/geometry/triangle_mesh.h>

#include <memory>
#include <span>

namespace lefort::report {

/// A search tree over the triangles of some meshes.
class RayScene {
 public:
  /// \param meshes  the vertices of every triangle exist; coordinates are finite, within +-1e9 mm.
  /// \returns the scene, or kInvalidArgument if Embree cannot start or memory is exhausted.
  [[nodiscard]] static Result<RayScene> build(
      std::span<const geometry::TriangleMesh* const> meshes);

  /// \param origin_L         of all rays.
  /// \param directions_L     of each ray, unit length.
  /// \param max_distance_mm  range of the rays; infinity is allowed.
  /// \returns the number of rays without a hit within their range.
  [[nodiscard]] int count_open(const Vec3& origin_L, std::span<const Vec3> directions_L,
                               double max_distance_mm) const;

 private:
  explicit RayScene(std::shared_ptr<void> scene) : scene_(std::move(scene)) {}
  std::shared_ptr<void> scene_;  ///< An RTCScene, which owns its device.
};

}  // namespace lefort::report
