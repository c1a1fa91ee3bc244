#include <lefort/geometry/bvh.h>
#include <lefort/geometry/mesh_properties.h>
#include <lefort/plan/bone_bodies.h>
#include <lefort/plan/check_volumes.h>
#include <lefort/plan/cut_segments.h>

#include <fmt/format.h>

#include <algorithm>

namespace lefort::plan {
namespace {

/// \returns the index of a segment among those before `end`; `end` if it is not among them.
std::size_t index_of(std::span<const PlannedSegment> planned, std::size_t end,
                     const std::string& name) {
  const auto last = planned.begin() + std::ptrdiff_t(end);
  return std::size_t(
      std::find_if(planned.begin(), last,
                   [&](const PlannedSegment& one) { return one.osteotomy.segment == name; }) -
      planned.begin());
}

/// A bone in one piece as the segment of an osteotomy that cuts nothing.
OsteotomyResult without_cut(geometry::TriangleMesh segment_L, geometry::TriangleMesh remainder_L) {
  OsteotomyResult bones;
  bones.segment_volume_mm3 = geometry::signed_volume_mm3(segment_L);
  bones.remainder_volume_mm3 = geometry::signed_volume_mm3(remainder_L);
  bones.skull_volume_mm3 = bones.segment_volume_mm3 + bones.remainder_volume_mm3;
  bones.segment_pieces = 1;
  bones.segment_L = std::move(segment_L);
  bones.remainder_L = std::move(remainder_L);
  return bones;
}

/// The whole mandible.
Result<OsteotomyResult> take_mandible(const geometry::TriangleMesh* mandible_L,
                                      const geometry::TriangleMesh& skull_L,
                                      const std::string& segment) {
  if (mandible_L == nullptr)
    return fail(ErrorCode::kAnatomyMissing,
                fmt::format("osteotomy of '{}': the mandible is not a bone of its own, must be "
                            "labeled as mandible and not be taken by an earlier segment",
                            segment));
  return without_cut(*mandible_L, skull_L);
}

/// The piece of bone at a point, of at least options.min_piece_ml.
Result<OsteotomyResult> take_piece(const geometry::TriangleMesh& source_L, const Vec3& at_L,
                                   const OsteotomyOptions& options, const std::string& segment) {
  constexpr double kNearPiece_mm = 5.0;  // As for anchor points.
  const std::vector<BoneBody> bodies = bodies_of(source_L);
  std::size_t nearest = bodies.size();
  double nearest_mm = kNearPiece_mm;
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    if (geometry::signed_volume_mm3(bodies[k].surface) < 1e3 * options.min_piece_ml) continue;
    if (geometry::bounding_box(bodies[k].surface).exteriorDistance(at_L) > nearest_mm) continue;
    const auto closest = geometry::Bvh(bodies[k].surface).closest_point(at_L, nearest_mm);
    if (!closest || (nearest < bodies.size() && closest->distance_mm >= nearest_mm)) continue;
    nearest = k;
    nearest_mm = closest->distance_mm;
  }
  if (nearest == bodies.size() || bodies.size() == 1)
    return fail(ErrorCode::kCutMissesBone,
                fmt::format("osteotomy of '{}': {}", segment,
                            bodies.size() == 1 ? "the bone is one piece, nothing would be left"
                                               : "no piece of bone lies within 5 mm of its point"));
  std::vector<bool> is_segment(bodies.size(), false), is_rest(bodies.size(), true);
  is_segment[nearest] = true;
  is_rest[nearest] = false;
  OsteotomyResult bones = without_cut(gather(bodies, is_segment), gather(bodies, is_rest));
  if (bones.segment_volume_mm3 > bones.remainder_volume_mm3)
    return fail(
        ErrorCode::kCutMissesBone,
        fmt::format("osteotomy of '{}': the piece at its point has {:.0f} ml, more than all "
                    "other bone; is it separated from the skull?",
                    segment, 1e-3 * bones.segment_volume_mm3));
  return bones;
}

/// One osteotomy of a plan.
Result<OsteotomyResult> cut_one(const geometry::TriangleMesh& source_L,
                                const geometry::TriangleMesh* mandible_L, const PlannedSegment& one,
                                Progress& progress) {
  if (one.is_whole_mandible) return take_mandible(mandible_L, source_L, one.osteotomy.segment);
  if (one.piece_at_L) return take_piece(source_L, *one.piece_at_L, one.cut, one.osteotomy.segment);
  return perform_osteotomy(source_L, one.osteotomy, one.cut, progress);
}

}  // namespace

bool takes_mandible(std::span<const PlannedSegment> planned) {
  return std::any_of(planned.begin(), planned.end(),
                     [](const PlannedSegment& one) { return one.is_whole_mandible; });
}

std::vector<geometry::RigidPath> paths_of(std::span<const PlannedSegment> planned) {
  std::vector<geometry::RigidPath> paths;
  for (const PlannedSegment& one : planned) paths.push_back(one.path);
  return paths;
}

Result<void> check_segments(std::span<const PlannedSegment> planned) {
  for (std::size_t k = 0; k < planned.size(); ++k) {
    const std::string& name = planned[k].osteotomy.segment;
    if (index_of(planned, k, name) != k)
      return fail(ErrorCode::kPlanInvalid, fmt::format("two segments are called '{}'", name));
    const std::string& from = planned[k].cut_from;
    if (!from.empty() && index_of(planned, k, from) == k)
      return fail(ErrorCode::kPlanInvalid,
                  fmt::format("segment '{}' is cut from '{}', which is not an earlier segment",
                              name, from));
  }
  return {};
}

Result<CutSegments> cut_segments(const geometry::TriangleMesh& skull_L,
                                 std::span<const PlannedSegment> planned, Progress& progress) {
  return cut_segments(skull_L, nullptr, planned, progress);
}

Result<CutSegments> cut_segments(const geometry::TriangleMesh& skull_L,
                                 const geometry::TriangleMesh* mandible_L,
                                 std::span<const PlannedSegment> planned, Progress& progress) {
  LEFORT_TRY_VOID(check_segments(planned));
  CutSegments all;
  all.remainder_L = skull_L;
  all.skull_volume_mm3 = geometry::signed_volume_mm3(skull_L) +
                         (mandible_L ? geometry::signed_volume_mm3(*mandible_L) : 0.0);
  for (std::size_t k = 0; k < planned.size(); ++k) {
    const PlannedSegment& one = planned[k];
    const std::size_t from = index_of(planned, k, one.cut_from);
    geometry::TriangleMesh& source = one.cut_from.empty() ? all.remainder_L : all.segments_L[from];
    LEFORT_TRY(OsteotomyResult bones, cut_one(source, mandible_L, one, progress));
    if (one.is_whole_mandible) mandible_L = nullptr;
    all.kerf_volume_mm3 += bones.kerf_volume_mm3;
    all.left_out_volume_mm3 += bones.left_out_volume_mm3;
    source = std::move(bones.remainder_L);
    if (!one.cut_from.empty()) all.volumes_mm3[from] = bones.remainder_volume_mm3;
    all.volumes_mm3.push_back(bones.segment_volume_mm3);
    all.segments_L.push_back(std::move(bones.segment_L));
    bones.remainder_L = {};
    bones.segment_L = {};
    all.cuts.push_back(std::move(bones));
  }
  all.remainder_volume_mm3 = geometry::signed_volume_mm3(all.remainder_L);
  std::vector<double> parts_mm3 = all.volumes_mm3;
  parts_mm3.insert(parts_mm3.end(), {all.remainder_volume_mm3, all.kerf_volume_mm3});
  LEFORT_TRY_VOID(
      check_volumes("all osteotomies", all.skull_volume_mm3 - all.left_out_volume_mm3, parts_mm3));
  return all;
}

}  // namespace lefort::plan
