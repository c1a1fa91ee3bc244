#include <lefort/anatomy/extract_surface.h>
#include <lefort/geometry/bvh.h>
#include <lefort/geometry/rigid_path.h>
#include <lefort/io/import_volume.h>
#include <lefort/io/plan_inputs.h>
#include <lefort/io/sha256.h>
#include <lefort/pipeline/prepare/find_head_landmarks.h>
#include <lefort/pipeline/prepare/load_head.h>
#include <lefort/plan/condylar_axis.h>

#include <fmt/format.h>

#include <algorithm>

namespace lefort::pipeline {

namespace fs = std::filesystem;

Result<plan::LandmarkSearch> find_head_landmarks(const image::CtVolume& ct,
                                                 const anatomy::LabelMap& labels,
                                                 const anatomy::LevelOptions& levels,
                                                 Progress& progress) {
  progress.begin_stage("extract surfaces");
  const auto bone_of = [&](anatomy::Bones bones) {
    return anatomy::extract_isosurface(
        anatomy::bone_level(ct, labels, anatomy::Cavities::kKeep, levels, bones), {}, progress);
  };
  LEFORT_TRY(const geometry::TriangleMesh skull_L, bone_of(anatomy::Bones::kSkull));
  std::optional<geometry::TriangleMesh> mandible_L;
  if (has_mandible(labels)) {
    LEFORT_TRY(mandible_L, bone_of(anatomy::Bones::kMandible));
  }
  LEFORT_TRY(const geometry::TriangleMesh skin_L,
             anatomy::extract_isosurface(anatomy::skin_level(ct, labels, levels), {}, progress));
  progress.begin_stage("find landmarks");
  return plan::find_landmarks({.skull_L = &skull_L,
                               .mandible_L = mandible_L ? &*mandible_L : nullptr,
                               .skin_L = &skin_L,
                               .voxel_mm = ct.grid.spacing_mm.maxCoeff()});
}

std::vector<std::string> remarks_of(const plan::LandmarkSearch& search) {
  std::vector<std::string> remarks;
  for (const plan::FoundLandmark& one : search.found)
    remarks.push_back(
        fmt::format("found automatically, standard uncertainty {:.1f} mm", one.uncertainty_mm));
  return remarks;
}

std::string describe(const plan::LandmarkSearch& search) {
  std::string text = fmt::format(
      "{} landmarks found automatically, with standard uncertainties in "
      "mm:",
      search.found.size());
  for (const plan::FoundLandmark& one : search.found)
    text += fmt::format(" {} {:.1f}", one.landmark.name, one.uncertainty_mm);
  if (search.missing.empty()) return text;
  text += "; not found:";
  for (const plan::MissingLandmark& one : search.missing)
    text += fmt::format(" {} ({})", one.name, one.reason);
  return text;
}

namespace {

/// Replaces the gaps between the teeth in a plan by angles.
Result<std::string> close_jaws(const fs::path& file, std::string text, const ScannedLabels& head,
                               Progress& progress) {
  const std::vector<io::JawGap> gaps = io::jaw_gaps(text);
  if (gaps.empty()) return text;
  for (const io::JawGap& gap : gaps) text = io::with_closing(text, gap, 0.0);
  LEFORT_TRY(const io::PlanText open, io::parse_completed_plan(file, text));
  if (!has_mandible(head.labels))
    return fail(ErrorCode::kAnatomyMissing, "autorotation to a gap: no mandible in the labels");
  progress.begin_stage("close the jaws");
  const auto bone_of = [&](anatomy::Bones bones) {
    return anatomy::extract_isosurface(
        anatomy::bone_level(head.scan.ct, head.labels, anatomy::Cavities::kKeep, head.levels,
                            bones),
        {}, progress);
  };
  LEFORT_TRY(geometry::TriangleMesh skull_L, bone_of(anatomy::Bones::kSkull));
  LEFORT_TRY(const geometry::TriangleMesh mandible_L, bone_of(anatomy::Bones::kMandible));
  LEFORT_TRY(const plan::CondylarAxis axis, plan::condylar_axis(open.plan.landmarks));
  LEFORT_TRY(const std::vector<Vec3> lower_L,
             plan::points_of_lower_teeth(mandible_L, open.plan.landmarks));
  const geometry::Bvh upper(std::move(skull_L));
  for (const io::JawGap& gap : gaps) {
    RigidTransform X_LB = RigidTransform::Identity();
    const auto& segments = open.plan.segments;
    const auto jaw = std::find_if(segments.begin(), segments.end(), [&](const auto& one) {
      return one.osteotomy.segment == gap.upper_jaw;
    });
    if (jaw != segments.end())
      X_LB = geometry::pose_at(jaw->path, 1.0);
    else if (!gap.upper_jaw.empty())
      return fail(ErrorCode::kPlanInvalid,
                  fmt::format("autorotate.to: the plan has no segment '{}'", gap.upper_jaw));
    LEFORT_TRY(const double closing_deg,
               plan::closing_to_gap(axis, lower_L, upper, X_LB, gap.gap_mm));
    progress.note(fmt::format("'{}' autorotates by {:.2f} degrees, to a gap of {:g} mm",
                              segments[gap.segment].osteotomy.segment, closing_deg, gap.gap_mm));
    text = io::with_closing(text, gap, closing_deg);
  }
  return text;
}

}  // namespace

Result<io::PlanText> read_plan_of_scan(const fs::path& file, const std::optional<fs::path>& given,
                                       const StageCache& cache, Progress& progress) {
  LEFORT_TRY(std::optional<io::OpenPlan> open, io::read_open_plan(file));
  if (!open) return io::read_plan_text(file);
  LEFORT_TRY(const fs::path ct_path, io::scan_of(file, open->plan, given));
  LEFORT_TRY(const ScannedLabels head, scan_labels(open->plan, ct_path, &cache, progress));
  std::string text = std::move(open->json);
  if (open->needs_landmarks) {
    LEFORT_TRY(const plan::LandmarkSearch search,
               find_head_landmarks(head.scan.ct, head.labels, head.levels, progress));
    progress.note(describe(search));
    text = io::with_landmarks(text, search.landmarks());
  }
  LEFORT_TRY(text, close_jaws(file, std::move(text), head, progress));
  return io::parse_completed_plan(file, std::move(text));
}

}  // namespace lefort::pipeline
