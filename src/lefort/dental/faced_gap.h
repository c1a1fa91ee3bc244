/// \file
/// The gap between a point of an arch and the surface of the other one.
#pragma once

#include <lefort/core/types.h>
#include <lefort/dental/beyond_border.h>
#include <lefort/geometry/bvh.h>

#include <optional>

namespace lefort::dental {

/// The gap of a point over a surface that faces it.
struct FacedGap {
  double gap_mm = 0.0;  ///< Negative: the point penetrates the surface.
  Vec3 point, normal;   ///< Of the surface.
};

/// Cosine of the largest angle between normals that face each other.
inline constexpr double kFacingCosine = -0.2;

/// \param p, n      a point of the other arch and its normal, in the frame of the surface.
/// \param reach_mm  furthest distance.
/// \returns nothing if the surface is further away, does not face the point, or ends before it.
[[nodiscard]] inline std::optional<FacedGap> gap_over(const geometry::Bvh& surface, const Vec3& p,
                                                      const Vec3& n, double reach_mm) {
  const auto nearest = surface.closest_point(p, reach_mm);
  if (!nearest) return std::nullopt;
  const Vec3 there =
      surface.pseudonormals().at(surface.mesh(), nearest->triangle, nearest->feature).normalized();
  if (!(there.dot(n) < kFacingCosine)) return std::nullopt;
  const Vec3 offset = p - nearest->point;
  if (is_beyond_border(offset, there)) return std::nullopt;
  return FacedGap{there.dot(offset), nearest->point, there};
}

}  // namespace lefort::dental
