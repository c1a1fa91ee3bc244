#include <lefort/geometry/bvh.h>
#include <lefort/geometry/mesh_properties.h>
#include <lefort/mesh/cut_surface.h>
#include <lefort/plan/bone_bodies.h>
#include <lefort/plan/check_volumes.h>
#include <lefort/plan/cut_solid.h>
#include <lefort/plan/fragments.h>
#include <lefort/plan/perform_osteotomy.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

namespace lefort::plan {
namespace {

using geometry::TriangleMesh;

constexpr double kMm3PerMl = 1000.0;
// Landmarks are picked on surfaces of bone, which may be rough. Heuristic.
constexpr double kAnchorTolerance_mm = 5.0;
constexpr double kSheet_mm = 0.01;  // Thickness of a sheet without kerf, until it is stitched.

tl::unexpected<Error> misses(const Osteotomy& osteotomy, const std::string& what) {
  return fail(ErrorCode::kCutMissesBone,
              fmt::format("osteotomy of '{}': {}", osteotomy.segment, what));
}

std::vector<bool> find_fragments(const std::vector<BoneBody>& bodies,
                                 const OsteotomyOptions& options) {
  double max_mm3 = 0.0;
  for (const BoneBody& body : bodies) max_mm3 = std::max(max_mm3, body.outer_volume_mm3);
  const double min_mm3 =
      std::max(options.min_piece_ml * kMm3PerMl, options.min_piece_fraction * max_mm3);
  std::vector<bool> is_fragment;
  is_fragment.reserve(bodies.size());
  for (const BoneBody& body : bodies) is_fragment.push_back(body.outer_volume_mm3 < min_mm3);
  return is_fragment;
}

/// \returns for each piece whether an anchor point lies on it. Pieces are excluded by the bound of
/// volume only, because the largest piece may not belong to the segment.
Result<std::vector<bool>> find_anchored(const std::vector<BoneBody>& bodies,
                                        const Osteotomy& osteotomy,
                                        const OsteotomyOptions& options) {
  std::vector<bool> is_anchored(bodies.size(), false);
  std::vector<double> nearest_mm(osteotomy.anchor_points_L.size(), kAnchorTolerance_mm);
  std::vector<std::size_t> nearest(osteotomy.anchor_points_L.size(), bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (bodies[b].outer_volume_mm3 < options.min_piece_ml * kMm3PerMl) continue;
    const geometry::Bvh tree(bodies[b].surface);
    for (std::size_t p = 0; p < nearest.size(); ++p) {
      const double distance_mm =
          std::max(tree.signed_distance(osteotomy.anchor_points_L[p]).distance_mm, 0.0);
      if (!(distance_mm < nearest_mm[p])) continue;
      nearest_mm[p] = distance_mm;
      nearest[p] = b;
    }
  }
  for (std::size_t p = 0; p < nearest.size(); ++p) {
    const Vec3& point = osteotomy.anchor_points_L[p];
    if (nearest[p] == bodies.size())
      return misses(
          osteotomy,
          fmt::format("no piece of {:g} ml or more within the cut lies within {:g} mm of the "
                      "anchor point ({:.1f}, {:.1f}, {:.1f}) mm",
                      options.min_piece_ml, kAnchorTolerance_mm, point.x(), point.y(), point.z()));
    is_anchored[nearest[p]] = true;
  }
  return is_anchored;
}

/// \returns for each piece whether it is larger than a fragment.
Result<std::vector<bool>> find_large(const std::vector<BoneBody>& bodies,
                                     const Osteotomy& osteotomy, const OsteotomyOptions& options) {
  std::vector<bool> is_large = find_fragments(bodies, options);
  is_large.flip();
  if (std::find(is_large.begin(), is_large.end(), true) != is_large.end()) return is_large;
  double all_mm3 = 0.0;
  for (const BoneBody& body : bodies) all_mm3 += body.volume_mm3;
  return misses(osteotomy,
                fmt::format("the cut contains {} fragments of {:.2g} ml in total, must contain a "
                            "piece of {} ml or more",
                            bodies.size(), all_mm3 / kMm3PerMl, options.min_piece_ml));
}

using Position = std::array<double, 3>;

std::set<Position> positions_of(const TriangleMesh& mesh) {
  std::set<Position> positions;
  for (const Vec3& v : mesh.vertices) positions.insert({v.x(), v.y(), v.z()});
  return positions;
}

/// The pieces within a cut: the segment and the fragments.
struct Sorted {
  TriangleMesh segment_L;
  Index segment_pieces = 0;
  std::vector<BoneBody> fragments;
};

Result<Sorted> sort_pieces(const std::vector<BoneBody>& bodies, std::vector<bool> within,
                           const Osteotomy& osteotomy, const OsteotomyOptions& options) {
  std::vector<BoneBody> inside;
  for (std::size_t b = 0; b < bodies.size(); ++b)
    if (within[b]) inside.push_back(bodies[b]);
  LEFORT_TRY(const std::vector<bool> is_segment, osteotomy.anchor_points_L.empty()
                                                     ? find_large(inside, osteotomy, options)
                                                     : find_anchored(inside, osteotomy, options));
  Sorted sorted;
  sorted.segment_L = gather(inside, is_segment);
  sorted.segment_pieces = std::count(is_segment.begin(), is_segment.end(), true);
  for (std::size_t b = 0; b < inside.size(); ++b)
    if (!is_segment[b]) sorted.fragments.push_back(std::move(inside[b]));
  return sorted;
}

/// The remainder without the kerf next to the segment.
struct Sawn {
  TriangleMesh remainder;
  double kerf_mm3 = 0.0;
};

Result<Sawn> remove_kerf(const TriangleMesh& outside, const TriangleMesh& segment_L,
                         const Osteotomy& osteotomy, const Box3& box, Progress& progress) {
  if (osteotomy.kerf_mm == 0.0) return Sawn{outside, 0.0};
  LEFORT_TRY(const TriangleMesh grown, cut_solid(osteotomy, box, osteotomy.kerf_mm));
  LEFORT_TRY(const mesh::SurfaceCut cut, mesh::cut_surface(outside, grown, progress));
  // The saw cuts next to the segment only, not next to fragments.
  const std::set<Position> of_segment = positions_of(segment_L);
  Sawn sawn{cut.outside, 0.0};
  for (const BoneBody& body : bodies_of(cut.inside)) {
    const bool is_kerf =
        std::any_of(body.surface.vertices.begin(), body.surface.vertices.end(), [&](const Vec3& v) {
          return of_segment.count({v.x(), v.y(), v.z()}) > 0;
        });
    if (is_kerf) sawn.kerf_mm3 += body.volume_mm3;
    if (!is_kerf) sawn.remainder = joined(sawn.remainder, body.surface);
  }
  return sawn;
}

/// The volume of the skull before the cut and of the bone that the saw removes.
struct Volumes {
  double skull_mm3;
  double kerf_mm3;
};

Result<OsteotomyResult> finish(OwnedBone owned, Index segment_pieces, const Volumes& volumes,
                               const Osteotomy& osteotomy) {
  if (owned.remainder_L.triangles.empty())
    return misses(osteotomy, "the kerf removes all bone outside the segment");
  OsteotomyResult bones;
  bones.segment_L = std::move(owned.segment_L);
  bones.remainder_L = std::move(owned.remainder_L);
  bones.fragments = std::move(owned.fragments);
  bones.segment_pieces = segment_pieces;
  bones.skull_volume_mm3 = volumes.skull_mm3;
  bones.kerf_volume_mm3 = volumes.kerf_mm3;
  bones.left_out_volume_mm3 = owned.left_out_mm3;
  bones.segment_volume_mm3 = geometry::signed_volume_mm3(bones.segment_L);
  bones.remainder_volume_mm3 = geometry::signed_volume_mm3(bones.remainder_L);
  LEFORT_TRY_VOID(check_volumes(
      fmt::format("osteotomy of '{}'", osteotomy.segment), volumes.skull_mm3 - owned.left_out_mm3,
      {{bones.segment_volume_mm3, bones.remainder_volume_mm3, bones.kerf_volume_mm3}}));
  return bones;
}

Box3 room_around(const TriangleMesh& surface) {
  Box3 box = geometry::bounding_box(surface);
  const Vec3 margin_mm = Vec3::Constant(10.0 + 0.05 * box.sizes().maxCoeff());
  box.extend(Vec3(box.min() - margin_mm));
  box.extend(Vec3(box.max() + margin_mm));
  return box;
}

Result<OsteotomyResult> cut_by_region(const TriangleMesh& skull_L, const Osteotomy& osteotomy,
                                      const OsteotomyOptions& options, Progress& progress) {
  const Box3 box = room_around(skull_L);
  mesh::SurfaceCut cut;
  if (is_of_planes(osteotomy)) {
    LEFORT_TRY(cut, mesh::cut_surface(skull_L, half_spaces_of(osteotomy.planes), progress));
  } else {
    LEFORT_TRY(const TriangleMesh solid, cut_solid(osteotomy, box, 0.0));
    LEFORT_TRY(cut, mesh::cut_surface(skull_L, solid, progress));
  }
  if (cut.inside.triangles.empty()) return misses(osteotomy, "no bone lies inside its planes");
  if (cut.outside.triangles.empty()) return misses(osteotomy, "all bone lies inside its planes");
  const std::vector<BoneBody> bodies = bodies_of(cut.inside);
  LEFORT_TRY(Sorted sorted,
             sort_pieces(bodies, std::vector<bool>(bodies.size(), true), osteotomy, options));
  OwnedBone owned = assign_fragments(
      {std::move(sorted.segment_L), std::move(sorted.fragments), std::move(cut.outside)},
      options.min_piece_ml * kMm3PerMl);
  LEFORT_TRY(Sawn sawn, remove_kerf(owned.remainder_L, owned.segment_L, osteotomy, box, progress));
  owned.remainder_L = std::move(sawn.remainder);
  return finish(std::move(owned), sorted.segment_pieces, {cut.whole_volume_mm3, sawn.kerf_mm3},
                osteotomy);
}

/// Area of a body's surface at a sheet.
struct SheetAreas {
  double before_mm2 = 0.0;  ///< On the side of the segment.
  double behind_mm2 = 0.0;
};

/// Thickness of sheets, and the displacement of SurfaceCut with which they cut.
struct SheetCut {
  double thickness_mm;
  double shift_mm;
};

std::vector<SheetAreas> areas_at_sheets(const TriangleMesh& body, const Osteotomy& osteotomy,
                                        const SheetCut& sheets) {
  const double in_mm = 1e-3 + sheets.shift_mm, thickness_mm = sheets.thickness_mm;
  std::vector<SheetAreas> areas(osteotomy.planes.size());
  for (Index t = 0; t < body.triangle_count(); ++t) {
    const Vec3 &a = body.corner(t, 0), &b = body.corner(t, 1), &c = body.corner(t, 2);
    const Vec3 twice_area = (b - a).cross(c - a), middle = (a + b + c) / 3.0;
    for (std::size_t i = 0; i < osteotomy.planes.size(); ++i) {
      const CutPlane& plane = osteotomy.planes[i];
      const Vec3 normal = plane.normal_L.normalized();
      const auto lies_at = [&](double height_mm) {
        return std::max({std::abs(normal.dot(a - plane.point_L) - height_mm),
                         std::abs(normal.dot(b - plane.point_L) - height_mm),
                         std::abs(normal.dot(c - plane.point_L) - height_mm)}) < in_mm;
      };
      const Vec3 up = normal.cross(plane.bounds->across_L).normalized();
      const Vec3 from = middle - plane.point_L;
      if (std::abs(up.dot(from)) > 0.5 * plane.bounds->height_mm ||
          std::abs(up.cross(normal).dot(from)) > 0.5 * plane.bounds->width_mm)
        continue;
      // The bone ends at the sheet: its outward normal points into the sheet.
      const double towards_mm2 = 0.5 * twice_area.dot(normal);
      if (towards_mm2 < 0.0 && lies_at(0.0)) areas[i].before_mm2 -= towards_mm2;
      if (towards_mm2 > 0.0 && lies_at(-thickness_mm)) areas[i].behind_mm2 += towards_mm2;
    }
  }
  return areas;
}

/// Position of a body relative to the sheets. Sheets that extend slightly into bone beyond the
/// segment leave a slit in it, with equal areas on both sides; the position of such a body is that
/// of nearly all of its area at sheets.
enum class Side { kBefore, kBehind, kAway };

Result<Side> side_of(const TriangleMesh& body, const Osteotomy& osteotomy, const SheetCut& sheets) {
  constexpr double kSlit = 0.1;  // Area on the other side over that on the body's side. Heuristic.
  SheetAreas all, largest;
  std::size_t sheet = 0;
  const std::vector<SheetAreas> areas = areas_at_sheets(body, osteotomy, sheets);
  for (std::size_t i = 0; i < areas.size(); ++i) {
    const auto& [before_mm2, behind_mm2] = areas[i];
    all.before_mm2 += before_mm2;
    all.behind_mm2 += behind_mm2;
    if (std::min(before_mm2, behind_mm2) <= std::min(largest.before_mm2, largest.behind_mm2))
      continue;
    largest = areas[i];
    sheet = i;
  }
  if (all.before_mm2 == 0.0 && all.behind_mm2 == 0.0) return Side::kAway;
  if (all.behind_mm2 <= kSlit * all.before_mm2) return Side::kBefore;
  if (all.before_mm2 <= kSlit * all.behind_mm2) return Side::kBehind;
  return misses(osteotomy, fmt::format("plane {} does not separate the bone: the segment is still "
                                       "connected to the remainder beyond its edges",
                                       sheet));
}

Result<OsteotomyResult> cut_by_sheets(const TriangleMesh& skull_L, const Osteotomy& osteotomy,
                                      const OsteotomyOptions& options, Progress& progress) {
  const double thickness_mm = std::max(osteotomy.kerf_mm, kSheet_mm);
  LEFORT_TRY(const TriangleMesh solid, sheet_solid(osteotomy, thickness_mm));
  LEFORT_TRY(const mesh::SurfaceCut cut, mesh::cut_surface(skull_L, solid, progress));
  if (cut.inside.triangles.empty()) return misses(osteotomy, "its planes cut no bone");
  const std::vector<BoneBody> bodies = bodies_of(cut.outside);
  std::vector<bool> is_before, is_other;
  for (const BoneBody& body : bodies) {
    LEFORT_TRY(const Side side,
               side_of(body.surface, osteotomy, {thickness_mm, cut.plane_shift_mm}));
    is_before.push_back(side == Side::kBefore);
    is_other.push_back(side != Side::kBefore);
  }
  if (std::find(is_before.begin(), is_before.end(), true) == is_before.end())
    return misses(osteotomy, "no bone lies on the segment's side of its planes");
  LEFORT_TRY(Sorted sorted, sort_pieces(bodies, is_before, osteotomy, options));
  const bool has_kerf = osteotomy.kerf_mm > 0.0;
  TriangleMesh remainder = gather(bodies, is_other);
  if (!has_kerf) remainder = joined(remainder, cut.inside);
  OwnedBone owned = assign_fragments(
      {std::move(sorted.segment_L), std::move(sorted.fragments), std::move(remainder)},
      options.min_piece_ml * kMm3PerMl);
  return finish(std::move(owned), sorted.segment_pieces,
                {cut.whole_volume_mm3, has_kerf ? cut.inside_volume_mm3 : 0.0}, osteotomy);
}

Result<void> check(const OsteotomyOptions& options) {
  if (!(options.min_piece_ml >= 0.0) || !std::isfinite(options.min_piece_ml))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("min_piece_ml is {}, must be >= 0", options.min_piece_ml));
  if (!(options.min_piece_fraction >= 0.0 && options.min_piece_fraction <= 1.0))
    return fail(ErrorCode::kInvalidArgument, fmt::format("min_piece_fraction is {}, must be 0 to 1",
                                                         options.min_piece_fraction));
  return {};
}

}  // namespace

Result<OsteotomyResult> perform_osteotomy(const TriangleMesh& skull_L, const Osteotomy& osteotomy,
                                          const OsteotomyOptions& options, Progress& progress) {
  LEFORT_TRY_VOID(check(options));
  LEFORT_TRY_VOID(check_osteotomy(osteotomy));
  return is_of_sheets(osteotomy) ? cut_by_sheets(skull_L, osteotomy, options, progress)
                                 : cut_by_region(skull_L, osteotomy, options, progress);
}

}  // namespace lefort::plan
