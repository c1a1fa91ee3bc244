#include <lefort/anatomy/extract_surface.h>
#include <lefort/geometry/rigid_path.h>
#include <lefort/io/plan_inputs.h>
#include <lefort/pipeline/prepare/close_jaws.h>
#include <lefort/plan/upper_bones.h>

#include <fmt/format.h>

#include <map>
#include <utility>
#include <vector>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;

/// The jaws of a head before surgery, and a plan in which all unknown angles are zero.
struct OpenJaws {
  io::PlanFile plan;
  geometry::TriangleMesh skull_L;
  std::vector<Vec3> lower_L;  ///< Points of the lower teeth.
  plan::CondylarAxis axis;
};

Result<OpenJaws> open_jaws(io::PlanFile plan, const ScannedLabels& head, Progress& progress) {
  const auto surface_of = [&](anatomy::Bones bones) {
    return anatomy::extract_isosurface(
        anatomy::bone_level(head.scan.ct, head.labels, anatomy::Cavities::kFillSinuses, head.levels,
                            bones),
        {}, progress);
  };
  LEFORT_TRY(const plan::CondylarAxis axis, plan::condylar_axis(plan.landmarks));
  LEFORT_TRY(geometry::TriangleMesh skull_L, surface_of(anatomy::Bones::kSkull));
  LEFORT_TRY(const geometry::TriangleMesh mandible_L, surface_of(anatomy::Bones::kMandible));
  LEFORT_TRY(std::vector<Vec3> lower_L, plan::points_of_lower_teeth(mandible_L, plan.landmarks));
  return OpenJaws{std::move(plan), std::move(skull_L), std::move(lower_L), axis};
}

/// The bones that the lower teeth can meet, by the name of the segment with the upper teeth.
class UpperJaws {
 public:
  explicit UpperJaws(const OpenJaws& jaws) : jaws_(jaws) {}

  Result<const std::vector<plan::UpperBone>*> find(const std::string& upper_jaw,
                                                   Progress& progress) {
    std::vector<plan::UpperBone>& bones = found_[upper_jaw];
    if (bones.empty() && upper_jaw.empty())
      bones.push_back({geometry::Bvh(jaws_.skull_L), RigidTransform::Identity()});
    if (bones.empty()) {
      LEFORT_TRY(bones, plan::upper_bones(jaws_.skull_L, jaws_.plan.segments, upper_jaw, progress));
    }
    return &bones;
  }

 private:
  const OpenJaws& jaws_;
  std::map<std::string, std::vector<plan::UpperBone>> found_;
};

Result<double> angle_of(const io::JawGap& gap, const OpenJaws& jaws, UpperJaws& upper,
                        Progress& progress) {
  const plan::PlannedSegment& lower = jaws.plan.segments[gap.segment];
  if (gap.upper_jaw == lower.osteotomy.segment)
    return fail(ErrorCode::kPlanInvalid,
                fmt::format("autorotate.to: segment '{}' cannot close to itself", gap.upper_jaw));
  LEFORT_TRY(const std::vector<plan::UpperBone>* bones, upper.find(gap.upper_jaw, progress));
  LEFORT_TRY(const double closing_deg,
             plan::closing_to_gap(jaws.axis, jaws.lower_L, *bones, gap.gap_mm,
                                  lower.path.keyframes[gap.keyframe]));
  progress.note(fmt::format("'{}' autorotates by {:.2f} degrees, to a gap of {:g} mm",
                            lower.osteotomy.segment, closing_deg, gap.gap_mm));
  return closing_deg;
}

}  // namespace

Result<std::string> close_jaws(const fs::path& file, std::string text, const ScannedLabels& head,
                               Progress& progress) {
  const std::vector<io::JawGap> gaps = io::jaw_gaps(text);
  if (gaps.empty()) return text;
  for (const io::JawGap& gap : gaps) text = io::with_closing(text, gap, 0.0);
  LEFORT_TRY(io::PlanText open, io::parse_completed_plan(file, text));
  if (!has_mandible(head.labels))
    return fail(ErrorCode::kAnatomyMissing, "autorotation to a gap: no mandible in the labels");
  progress.begin_stage("close the jaws");
  LEFORT_TRY(const OpenJaws jaws, open_jaws(std::move(open.plan), head, progress));
  UpperJaws upper(jaws);
  std::map<std::string, double> closings_deg;  // Of each segment; that of its last keyframe.
  for (const io::JawGap& gap : gaps) {
    if (!gap.as.empty()) continue;
    LEFORT_TRY(const double closing_deg, angle_of(gap, jaws, upper, progress));
    closings_deg[jaws.plan.segments[gap.segment].osteotomy.segment] = closing_deg;
    text = io::with_closing(text, gap, closing_deg);
  }
  for (const io::JawGap& gap : gaps) {
    if (gap.as.empty()) continue;
    const auto closing = closings_deg.find(gap.as);
    if (closing == closings_deg.end())
      return fail(ErrorCode::kPlanInvalid,
                  fmt::format("autorotate.as: no segment '{}' closes to a gap", gap.as));
    text = io::with_closing(text, gap, closing->second);
  }
  return text;
}

}  // namespace lefort::pipeline
