#include <lefort/plan/upper_bones.h>

#include <fmt/format.h>

#include <map>
#include <optional>
#include <utility>

namespace lefort::plan {
namespace {

/// Whether the procedure cuts the mandible only, so that the skull need not be tried.
bool is_mandibular(const PlannedSegment& one) {
  const auto& procedure = one.osteotomy.procedure;
  return one.is_whole_mandible || procedure == OsteotomyTemplate::kGenioplasty ||
         procedure == OsteotomyTemplate::kSagittalSplit;
}

/// Cuts one segment from a bone of the skull, whose rest stays in `source_L`.
///
/// \returns the segment; nothing if it contains no bone of the skull.
Result<std::optional<geometry::TriangleMesh>> cut_one(geometry::TriangleMesh& source_L,
                                                      const PlannedSegment& one,
                                                      Progress& progress) {
  PlannedSegment alone = one;
  alone.cut_from.clear();
  Result<CutSegments> cut = cut_segments(source_L, {&alone, 1}, progress);
  if (!cut && cut.error().code == ErrorCode::kCutMissesBone) return std::nullopt;
  if (!cut) return tl::unexpected(std::move(cut.error()));
  source_L = std::move(cut->remainder_L);
  return std::move(cut->segments_L.front());
}

}  // namespace

Result<std::vector<UpperBone>> upper_bones(geometry::TriangleMesh skull_L,
                                           std::span<const PlannedSegment> planned,
                                           const std::string& upper_jaw, Progress& progress) {
  LEFORT_TRY_VOID(check_segments(planned));
  std::vector<std::pair<const PlannedSegment*, geometry::TriangleMesh>> cut;
  std::map<std::string, std::size_t> number;  // In `cut`.
  bool is_in_plan = false;
  for (const PlannedSegment& one : planned) {
    const std::string& name = one.osteotomy.segment;
    is_in_plan = is_in_plan || name == upper_jaw;
    const auto from = number.find(one.cut_from);
    if (is_mandibular(one) || (!one.cut_from.empty() && from == number.end())) continue;
    geometry::TriangleMesh& source_L = one.cut_from.empty() ? skull_L : cut[from->second].second;
    LEFORT_TRY(auto segment_L, cut_one(source_L, one, progress));
    if (!segment_L) continue;
    number[name] = cut.size();
    cut.emplace_back(&one, *std::move(segment_L));
  }
  if (!is_in_plan)
    return fail(ErrorCode::kPlanInvalid,
                fmt::format("autorotate.to: the plan has no segment '{}'", upper_jaw));
  if (!number.contains(upper_jaw))
    return fail(ErrorCode::kPlanInvalid,
                fmt::format("autorotate.to: segment '{}' contains no bone of the skull, must be "
                            "the segment with the upper teeth",
                            upper_jaw));
  std::vector<UpperBone> bones;
  for (auto& [one, surface_L] : cut)
    bones.push_back({geometry::Bvh(std::move(surface_L)), geometry::pose_at(one->path, 1.0)});
  bones.push_back({geometry::Bvh(std::move(skull_L)), RigidTransform::Identity()});
  return bones;
}

}  // namespace lefort::plan
