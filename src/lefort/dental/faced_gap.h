/// \file
/// The gap between a point of an arch and the surface of the other one.
#pragma once

#include <lefort/core/types.h>
#include <lefort/dental/beyond_border.h>
#include <lefort/geometry/bvh.h>

#include <optional>

namespace lefort::dental {

/// A point relative to the closest point of a surface.
struct SurfaceOffset {
  Vec3 point, normal;        ///< Of the surface; the normal has unit length.
  double distance_mm = 0.0;  ///< >= 0.
  double along_mm = 0.0;     ///< Along the normal; negative inside.
  bool is_beyond = false;    ///< Whether the surface ends before the point (is_beyond_border()).
};

/// \returns nothing if the surface is further away than `reach_mm`.
[[nodiscard]] inline std::optional<SurfaceOffset> offset_from(const geometry::Bvh& surface,
                                                              const Vec3& p, double reach_mm) {
  const auto nearest = surface.closest_point(p, reach_mm);
  if (!nearest) return std::nullopt;
  const Vec3 normal =
      surface.pseudonormals().at(surface.mesh(), nearest->triangle, nearest->feature).normalized();
  const Vec3 offset = p - nearest->point;
  return SurfaceOffset{nearest->point, normal, nearest->distance_mm, normal.dot(offset),
                       is_beyond_border(offset, normal)};
}

/// The gap of a point over a surface that faces it.
struct FacedGap {
  double gap_mm = 0.0;  ///< Negative: the point penetrates the surface.
  Vec3 point, normal;   ///< Of the surface.
};

/// Normals that face each other have a smaller cosine.
inline constexpr double kFacingCosine = -0.2;

/// \param p, n      a point of the other arch and its normal, in the frame of the surface.
/// \param reach_mm  furthest distance.
/// \returns nothing if the surface is further away, does not face the point, or ends before it.
[[nodiscard]] inline std::optional<FacedGap> gap_over(const geometry::Bvh& surface, const Vec3& p,
                                                      const Vec3& n, double reach_mm) {
  const auto there = offset_from(surface, p, reach_mm);
  if (!there || there->is_beyond || !(there->normal.dot(n) < kFacingCosine)) return std::nullopt;
  return FacedGap{there->along_mm, there->point, there->normal};
}

}  // namespace lefort::dental
