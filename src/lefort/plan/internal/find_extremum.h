/// \file
/// Extremal points of a set, and how well they are determined.
#pragma once

#include <lefort/core/types.h>

#include <optional>
#include <span>
#include <vector>

namespace lefort::plan::internal {

struct Extremum {
  Vec3 point;        ///< One of the points [mm].
  double spread_mm;  ///< RMS distance of the points within a voxel from the weighted mean.
};

/// The point that is furthest along a direction, robust to noise: of the points within a voxel of
/// the extreme value, the one closest to the weighted mean of the points within a quarter of a
/// voxel. Only points within 10 mm of the first extreme point count.
///
/// \param points     candidates; may be empty.
/// \param direction  unit length.
/// \param voxel_mm   > 0.
/// \returns nothing without candidates.
[[nodiscard]] std::optional<Extremum> find_extremum(std::span<const Vec3> points,
                                                    const Vec3& direction, double voxel_mm);

/// The point of a profile that is furthest posterior to the chord through two points, in the plane
/// normal to x.
///
/// \param profile   points of the profile; those between the heights z of the two are used.
/// \param one, two  ends of the chord, at different heights.
/// \param voxel_mm  as above.
/// \returns nothing if no point is between the two.
[[nodiscard]] std::optional<Extremum> find_deepest(std::span<const Vec3> profile, const Vec3& one,
                                                   const Vec3& two, double voxel_mm);

/// The points with heights z from `low_mm` to `high_mm`.
[[nodiscard]] std::vector<Vec3> between_heights(std::span<const Vec3> points, double low_mm,
                                                double high_mm);

}  // namespace lefort::plan::internal
