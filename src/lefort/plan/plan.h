/// \file
/// The geometry of osteotomies.
#pragma once

#include <lefort/core/types.h>

#include <optional>
#include <string>
#include <vector>

namespace lefort::plan {

/// Standard osteotomies (osteotomy_template.h), and the landmarks that place them.
enum class OsteotomyTemplate {
  kLeFort1,        ///< The tooth-bearing lower maxilla: ANS, PNS.
  kLeFort2,        ///< The pyramid of maxilla and nose: N, Or on both sides, ANS, PNS.
  kLeFort3,        ///< The midface with the zygomas: N, Or, FZ on both sides, ANS, PNS.
  kGenioplasty,    ///< The chin: Me, Pg, Go on both sides.
  kSagittalSplit,  ///< Bilateral (BSSO), the distal segment: Me; Go, Co, L6 on both sides.
};

/// Extent of a bounded cut plane: a rectangle centered at the plane's point.
struct PlaneBounds {
  Vec3 across_L;     ///< Direction of the width; its component along the normal is ignored.
  double width_mm;   ///< > 0.
  double height_mm;  ///< > 0, normal to width and plane normal.
};

/// A plane that bounds a segment: the normal points to the segment.
struct CutPlane {
  Vec3 point_L;   ///< Any point of the plane, or the center of the rectangle [mm].
  Vec3 normal_L;  ///< Towards the segment; unit length.
  std::optional<PlaneBounds> bounds = std::nullopt;  ///< None: the plane is unbounded.
};

/// A closed curve extruded along a direction; the segment lies inside.
struct CutCurve {
  std::vector<Vec3> points_L;  ///< Three or more, in order; the last is joined to the first.
  Vec3 direction_L;            ///< Into the bone; not zero. The curve is extruded along it.
  /// Depth of the cut, from the first point of the curve along the direction; none: through all
  /// bone. In the opposite direction, the cut is unbounded.
  std::optional<double> depth_mm = std::nullopt;
};

/// The points on the segment's side of every plane and inside every curve.
struct CutRegion {
  std::vector<CutPlane> planes;
  std::vector<CutCurve> curves;
};

/// The segment is the bone within `planes` and `curves`, for example the midface anterior to a
/// coronal plane and inferior to an axial one, together with the bone within any one of
/// `additional_regions`.
///
/// Bounded planes (sheets) are another kind of cut. They cannot be combined with curves, unbounded
/// planes or additional regions. The bone on the side of their normals is the segment. The segment
/// must not be connected to the remainder beyond the edges of the planes.
struct Osteotomy {
  std::string segment;  ///< Name of the segment.
  std::vector<CutPlane> planes;
  std::vector<CutCurve> curves{};
  std::vector<CutRegion> additional_regions{};
  /// If not empty, the segment consists of the pieces on which these points lie; other pieces
  /// within the cut stay with the remainder.
  std::vector<Vec3> anchor_points_L{};
  /// Width of bone removed by the saw, from the remainder next to the segment's cut faces; 0 to 5.
  double kerf_mm = 0.0;
  /// The procedure, if it is known; the elevation margins depend on it (elevation_zone.h).
  std::optional<OsteotomyTemplate> procedure = std::nullopt;
};

}  // namespace lefort::plan
