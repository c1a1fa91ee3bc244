#include <lefort/mesh/combine_solids.h>
#include <lefort/plan/cut_solid.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace lefort::plan {
namespace {

using geometry::TriangleMesh;

bool is_bounded(const CutPlane& plane) { return plane.bounds.has_value(); }

/// \returns why the plane is invalid, empty if it is valid.
std::string invalid_reason(const CutPlane& plane) {
  if (!plane.point_L.allFinite()) return "its point is not finite";
  if (!plane.normal_L.allFinite() || !(plane.normal_L.norm() > 1e-6))
    return fmt::format("its normal has length {}, must be above 0", plane.normal_L.norm());
  if (!plane.bounds) return {};
  const auto& [across_L, width_mm, height_mm] = *plane.bounds;
  if (!(width_mm > 0.0 && height_mm > 0.0) || !std::isfinite(width_mm + height_mm))
    return fmt::format("its size is {} x {} mm, must be above 0", width_mm, height_mm);
  if (!across_L.allFinite() || !(across_L.cross(plane.normal_L).norm() > 1e-6 * across_L.norm()))
    return "its width direction must not be parallel to its normal";
  return {};
}

std::string invalid_reason(const CutCurve& curve) {
  if (curve.depth_mm && (!(*curve.depth_mm > 0.0) || !std::isfinite(*curve.depth_mm)))
    return fmt::format("its depth is {} mm, must be above 0", *curve.depth_mm);
  const auto prism = mesh::make_prism(curve.points_L, curve.direction_L, 0.0, 1.0);
  return prism ? std::string() : prism.error().message;
}

std::string invalid_reason(const std::vector<CutPlane>& planes,
                           const std::vector<CutCurve>& curves) {
  for (std::size_t i = 0; i < planes.size(); ++i)
    if (const std::string why = invalid_reason(planes[i]); !why.empty())
      return fmt::format("plane {}: {}", i, why);
  for (std::size_t i = 0; i < curves.size(); ++i)
    if (const std::string why = invalid_reason(curves[i]); !why.empty())
      return fmt::format("curve {}: {}", i, why);
  return {};
}

/// \returns the range of p . direction in the box.
std::array<double, 2> heights_in(const Box3& box, const Vec3& direction) {
  std::array<double, 2> range{std::numeric_limits<double>::infinity(),
                              -std::numeric_limits<double>::infinity()};
  for (int corner = 0; corner < 8; ++corner) {
    const double height = direction.dot(box.corner(Box3::CornerType(corner)));
    range = {std::min(range[0], height), std::max(range[1], height)};
  }
  return range;
}

Result<TriangleMesh> prism_of(const CutCurve& curve, const Box3& box, double grow_mm) {
  const Vec3 direction = curve.direction_L.normalized();
  auto [from_mm, to_mm] = heights_in(box, direction);
  if (curve.depth_mm)
    to_mm = std::min(to_mm, direction.dot(curve.points_L[0]) + *curve.depth_mm + grow_mm);
  from_mm = std::min(from_mm, to_mm - 1.0);  // Keeps a prism that misses the bone valid.
  return mesh::make_prism(curve.points_L, direction, from_mm, to_mm, grow_mm);
}

Result<TriangleMesh> solid_of(const CutRegion& region, const Box3& box, double grow_mm) {
  std::vector<mesh::HalfSpace> half_spaces = half_spaces_of(region.planes);
  for (mesh::HalfSpace& half : half_spaces) half.point -= grow_mm * half.normal.normalized();
  TriangleMesh solid = mesh::convex_solid(half_spaces, box);
  for (const CutCurve& curve : region.curves) {
    LEFORT_TRY(const TriangleMesh prism, prism_of(curve, box, grow_mm));
    LEFORT_TRY(solid, mesh::intersect(solid, prism));
  }
  return solid;
}

}  // namespace

Result<void> check_osteotomy(const Osteotomy& osteotomy) {
  const auto bad = [&](const std::string& what) {
    return fail(ErrorCode::kPlanInvalid,
                fmt::format("osteotomy of '{}': {}", osteotomy.segment, what));
  };
  if (osteotomy.planes.empty() && osteotomy.curves.empty())
    return bad("`planes` is empty, must have one or more");
  if (!(osteotomy.kerf_mm >= 0.0 && osteotomy.kerf_mm <= kMaxKerf_mm))
    return bad(fmt::format("the kerf of the saw is {} mm, must be 0 to {:g}", osteotomy.kerf_mm,
                           kMaxKerf_mm));
  if (const std::string why = invalid_reason(osteotomy.planes, osteotomy.curves); !why.empty())
    return bad(why);
  bool is_other_bounded = false;
  for (std::size_t r = 0; r < osteotomy.additional_regions.size(); ++r) {
    const CutRegion& region = osteotomy.additional_regions[r];
    if (region.planes.empty() && region.curves.empty())
      return bad(fmt::format("additional_regions[{}] has neither planes nor curves", r));
    if (const std::string why = invalid_reason(region.planes, region.curves); !why.empty())
      return bad(fmt::format("additional_regions[{}]: {}", r, why));
    is_other_bounded |= std::any_of(region.planes.begin(), region.planes.end(), is_bounded);
  }
  const auto bounded = std::count_if(osteotomy.planes.begin(), osteotomy.planes.end(), is_bounded);
  const bool has_others = bounded != std::ptrdiff_t(osteotomy.planes.size()) ||
                          !osteotomy.curves.empty() || !osteotomy.additional_regions.empty();
  if (is_other_bounded || (bounded > 0 && has_others))
    return bad(
        "bounded planes cannot be combined with curves, unbounded planes or `additional_regions`");
  for (const Vec3& point : osteotomy.anchor_points_L)
    if (!point.allFinite()) return bad("an anchor point is not finite");
  return {};
}

bool is_of_sheets(const Osteotomy& osteotomy) {
  return !osteotomy.planes.empty() && is_bounded(osteotomy.planes.front());
}

bool is_of_planes(const Osteotomy& osteotomy) {
  return osteotomy.curves.empty() && osteotomy.additional_regions.empty() &&
         !is_of_sheets(osteotomy);
}

std::vector<mesh::HalfSpace> half_spaces_of(const std::vector<CutPlane>& planes) {
  std::vector<mesh::HalfSpace> half_spaces;
  for (const CutPlane& plane : planes) half_spaces.push_back({plane.point_L, plane.normal_L});
  return half_spaces;
}

Result<TriangleMesh> cut_solid(const Osteotomy& osteotomy, const Box3& box, double grow_mm) {
  // Without it, boxes of regions that end in the same plane would touch face to face.
  constexpr double kStagger_mm = 0.25;
  Box3 room = box;
  LEFORT_TRY(TriangleMesh solid, solid_of({osteotomy.planes, osteotomy.curves}, room, grow_mm));
  for (const CutRegion& region : osteotomy.additional_regions) {
    room.min() -= Vec3::Constant(kStagger_mm);
    room.max() += Vec3::Constant(kStagger_mm);
    LEFORT_TRY(const TriangleMesh more, solid_of(region, room, grow_mm));
    LEFORT_TRY(solid, mesh::unite(solid, more));
  }
  return solid;
}

Result<TriangleMesh> sheet_solid(const Osteotomy& osteotomy, double thickness_mm) {
  TriangleMesh solid;
  for (const CutPlane& plane : osteotomy.planes) {
    const Vec3 normal = plane.normal_L.normalized();
    const Vec3 up = normal.cross(plane.bounds->across_L).normalized(), across = up.cross(normal);
    const Vec3 w = 0.5 * plane.bounds->width_mm * across, h = 0.5 * plane.bounds->height_mm * up;
    const Vec3& p = plane.point_L;
    const std::array<Vec3, 4> corners{p - w - h, p + w - h, p + w + h, p - w + h};
    const double at_mm = normal.dot(p);
    LEFORT_TRY(const TriangleMesh slab,
               mesh::make_prism(corners, normal, at_mm - thickness_mm, at_mm));
    LEFORT_TRY(solid, mesh::unite(solid, slab));
  }
  return solid;
}

}  // namespace lefort::plan
