/// \file
/// The only place that knows Embree: which triangle does a ray meet first.
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
  std::uint32_t triangle;  ///< Of the mesh that was hit; with several meshes it says nothing.
  double u, v;             ///< Weights of the triangle's second and third corner.
};

/// A search tree over the triangles of some meshes.
class RayScene {
 public:
  /// \pre every triangle names vertices that exist, coordinates are finite and below 1e9.
  /// \returns kInvalidArgument when Embree cannot start or runs out of memory.
  [[nodiscard]] static Result<RayScene> build(
      std::span<const geometry::TriangleMesh* const> meshes);

  /// The nearest triangle along `direction` (unit length).
  [[nodiscard]] std::optional<RayHit> closest(const Vec3& origin_L, const Vec3& direction_L) const;

  /// Whether anything lies within `reach_mm` along `direction` (unit length).
  [[nodiscard]] bool blocked(const Vec3& origin_L, const Vec3& direction_L, double reach_mm) const;

 private:
  explicit RayScene(std::shared_ptr<void> scene) : scene_(std::move(scene)) {}
  std::shared_ptr<void> scene_;  ///< An RTCScene, which keeps its device.
};

}  // namespace lefort::report
