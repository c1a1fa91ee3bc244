/// \file
/// What the surgeon wants: bone cuts, and the way each cut piece moves. A value.
#pragma once

#include <lefort/core/types.h>

#include <optional>
#include <string>
#include <vector>

namespace lefort::plan {

/// How far a saw goes in a plane: a rectangle about the plane's point.
struct PlaneBounds {
  Vec3 across_L;     ///< Along the width; what of it lies across the plane's normal counts.
  double width_mm;   ///< > 0.
  double height_mm;  ///< > 0, across width and normal.
};

/// A plane that bounds a segment: the segment lies on the side the normal points to.
struct CutPlane {
  Vec3 point_L;   ///< Any point of the plane, or the rectangle's middle [mm].
  Vec3 normal_L;  ///< Towards the segment; unit length.
  std::optional<PlaneBounds> bounds = std::nullopt;  ///< None: the plane has no end.
};

/// A closed curve moved along a direction, like a cookie cutter; the segment lies within it.
struct CutCurve {
  std::vector<Vec3> points_L;  ///< Three or more, in order; the last is joined to the first.
  Vec3 direction_L;            ///< Into the bone; not zero. The curve is seen along it.
  /// From the curve's first point along the direction; none: through all bone. Outwards, against
  /// the direction, the cutter has no end.
  std::optional<double> depth_mm = std::nullopt;
};

/// What lies on the inner side of every plane and within every curve.
struct CutRegion {
  std::vector<CutPlane> planes;
  std::vector<CutCurve> curves;
};

/// Frees the bone within `planes` and `curves`, for example the mid-face in front of a coronal
/// plane and below an axial one; and within each of `also`, if there are any.
///
/// Bounded planes are another kind of cut: sheets, which do not stand beside curves, unbounded
/// planes or `also`. The bone in front of them is the segment, and must not hang together with the
/// bone behind them around their edges.
struct Osteotomy {
  std::string segment;  ///< The name of the piece it frees.
  std::vector<CutPlane> planes;
  std::vector<CutCurve> curves{};
  std::vector<CutRegion> additional_regions{};
  /// If not empty, the segment is the pieces on which these points lie; other pieces within the cut
  /// stay with the remainder.
  std::vector<Vec3> anchor_points_L{};
  /// What the saw turns to dust, next to the segment's cut faces, off the bone that remains; 0 for
  /// a cut without width.
  double kerf_mm = 0.0;
};

}  // namespace lefort::plan
