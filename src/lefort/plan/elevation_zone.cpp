#include <lefort/plan/bone_bodies.h>
#include <lefort/plan/elevation_zone.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <unordered_map>

namespace lefort::plan {
namespace {

/// Vertices of a cut lie in its plane up to the rounding of boolean operations and the collapse of
/// short edges (mesh/finish_surface.h).
constexpr double kInCutSurface_mm = 0.02;

/// Whether a point lies on one part of a cut.
using OnCut = std::function<bool(const Vec3&)>;

bool is_within_bounds(const CutPlane& plane, const Vec3& p_L) {
  if (!plane.bounds) return true;
  const Vec3 across =
      (plane.bounds->across_L - plane.normal_L.dot(plane.bounds->across_L) * plane.normal_L)
          .normalized();
  const Vec3 up = plane.normal_L.cross(across), d = p_L - plane.point_L;
  return std::abs(across.dot(d)) <= 0.5 * plane.bounds->width_mm + kInCutSurface_mm &&
         std::abs(up.dot(d)) <= 0.5 * plane.bounds->height_mm + kInCutSurface_mm;
}

OnCut on_plane(const CutPlane& plane) {
  return [plane](const Vec3& p_L) {
    return std::abs(plane.normal_L.dot(p_L - plane.point_L)) <= kInCutSurface_mm &&
           is_within_bounds(plane, p_L);
  };
}

/// One side of an extruded curve: the strip along `direction` through the edge from `a` to `b`.
OnCut on_side(const Vec3& a_L, const Vec3& b_L, const Vec3& direction) {
  const Vec3 along = b_L - a_L - direction.dot(b_L - a_L) * direction;
  const double length_mm = along.norm();
  const Vec3 unit = length_mm > 0.0 ? Vec3(along / length_mm) : Vec3::Zero().eval();
  return [=](const Vec3& p_L) {
    const Vec3 d = p_L - a_L - direction.dot(p_L - a_L) * direction;
    const double t_mm = unit.dot(d);
    return t_mm >= -kInCutSurface_mm && t_mm <= length_mm + kInCutSurface_mm &&
           (d - t_mm * unit).norm() <= kInCutSurface_mm;
  };
}

void add_parts(const CutRegion& region, std::vector<OnCut>& parts) {
  for (const CutPlane& plane : region.planes) parts.push_back(on_plane(plane));
  for (const CutCurve& curve : region.curves) {
    const Vec3 direction = curve.direction_L.normalized();
    const std::size_t count = curve.points_L.size();
    for (std::size_t i = 0; i < count; ++i)
      parts.push_back(on_side(curve.points_L[i], curve.points_L[(i + 1) % count], direction));
    if (curve.depth_mm)
      parts.push_back(on_plane({.point_L = curve.points_L.front() + *curve.depth_mm * direction,
                                .normal_L = direction}));
  }
}

}  // namespace

/// The segment is perfused by the tissue left on it (\cite bell1975).
ElevationMargins elevation_margins(std::optional<OsteotomyTemplate> procedure) {
  if (!procedure) return {};
  switch (*procedure) {
    case OsteotomyTemplate::kLeFort1:
      return {.segment_mm = 5.0, .other_side_mm = 12.0};
    case OsteotomyTemplate::kLeFort2:
    case OsteotomyTemplate::kLeFort3:
      return {.segment_mm = 8.0, .other_side_mm = 15.0};
    case OsteotomyTemplate::kGenioplasty:
      return {.segment_mm = 3.0, .other_side_mm = 10.0};
    case OsteotomyTemplate::kSagittalSplit:
      return {.segment_mm = 10.0, .other_side_mm = 10.0};
  }
  return {};
}

geometry::TriangleMesh cut_faces(const geometry::TriangleMesh& surface_L,
                                 const Osteotomy& osteotomy) {
  std::vector<OnCut> parts;
  add_parts({osteotomy.planes, osteotomy.curves}, parts);
  for (const CutRegion& region : osteotomy.additional_regions) add_parts(region, parts);
  geometry::TriangleMesh faces;
  std::unordered_map<std::int32_t, std::int32_t> number_of;
  const auto copied = [&](std::int32_t vertex) {
    const auto [at, is_new] = number_of.try_emplace(vertex, std::int32_t(faces.vertices.size()));
    if (is_new) faces.vertices.push_back(surface_L.vertices[std::size_t(vertex)]);
    return at->second;
  };
  for (const geometry::Triangle& triangle : surface_L.triangles) {
    const bool is_cut = std::any_of(parts.begin(), parts.end(), [&](const OnCut& is_on) {
      return std::all_of(triangle.begin(), triangle.end(), [&](std::int32_t vertex) {
        return is_on(surface_L.vertices[std::size_t(vertex)]);
      });
    });
    if (is_cut)
      faces.triangles.push_back({copied(triangle[0]), copied(triangle[1]), copied(triangle[2])});
  }
  return faces;
}

std::vector<ElevationZone> elevation_zones(const CutSegments& cut,
                                           std::span<const PlannedSegment> planned,
                                           std::optional<double> margin_mm) {
  std::vector<ElevationZone> zones;
  for (const PlannedSegment& one : planned) {
    ElevationZone zone;
    zone.margins = margin_mm ? ElevationMargins{*margin_mm, *margin_mm}
                             : elevation_margins(one.osteotomy.procedure);
    for (const geometry::TriangleMesh& segment_L : cut.segments_L)
      append(zone.cut_faces_L, cut_faces(segment_L, one.osteotomy));
    zones.push_back(std::move(zone));
  }
  return zones;
}

}  // namespace lefort::plan
