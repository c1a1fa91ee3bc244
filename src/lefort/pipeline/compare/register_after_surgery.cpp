#include <lefort/anatomy/extract_surface.h>
#include <lefort/anatomy/tissue_levels.h>
#include <lefort/geometry/transform_mesh.h>
#include <lefort/io/plan_file.h>
#include <lefort/io/predicted_poses.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/compare/register_after_surgery.h>
#include <lefort/pipeline/predict/write_prediction.h>
#include <lefort/pipeline/prepare/load_head.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <system_error>
#include <utility>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;

/// Where the saw, plates and healing leave the bone alone.
constexpr double kUntouched_mm = 10.0;
/// A segment's cut faces are planes of the plan: in a scan they are rounded, worn, or grown over.
constexpr double kCutFaces_mm = 2.0;

/// What was planned, as files tell.
struct PlannedBones {
  io::PlanFile plan;
  geometry::TriangleMesh remainder_L;
  std::vector<geometry::TriangleMesh> segments_B;
  std::vector<RigidTransform> planned_LB;
};

bool is_file(const fs::path& file) {
  std::error_code error;
  return fs::is_regular_file(file, error);
}

/// Where the prediction left the segments. Not what its plan says now: files that it names may have
/// changed since.
Result<std::vector<io::SegmentPose>> final_poses(const fs::path& file) {
  constexpr std::uintmax_t kLargest = 256 << 20;  // Bytes.
  LEFORT_TRY(const std::string text, io::read_text(file, kLargest));
  const auto document = nlohmann::json::parse(text, nullptr, false);
  const auto steps = document.find("steps");
  auto poses = steps != document.end() && steps->is_array() && !steps->empty()
                   ? io::predicted_poses(document, steps->back())
                   : fail(ErrorCode::kFileCorrupt, "the prediction has no steps");
  if (!poses)
    return fail(poses.error().code, fmt::format("{}: {}", file.string(), poses.error().message));
  return poses;
}

Result<PlannedBones> read_planned(const fs::path& prediction) {
  if (!is_file(prediction / "prediction.json") || !is_file(prediction / "plan.json"))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{} is no folder of a finished prediction: it has no prediction.json",
                            prediction.string()));
  PlannedBones planned;
  LEFORT_TRY(planned.plan, io::read_plan(prediction / "plan.json"));
  LEFORT_TRY(const std::vector<io::SegmentPose> poses, final_poses(prediction / "prediction.json"));
  LEFORT_TRY(planned.remainder_L, io::read_surface(prediction / "bone_remainder.vtp"));
  if (poses.size() != planned.plan.segments.size())
    return fail(ErrorCode::kFileCorrupt,
                fmt::format("plan.json and prediction.json in {} are of different plans",
                            prediction.string()));
  for (std::size_t k = 0; k < poses.size(); ++k) {
    LEFORT_TRY(geometry::TriangleMesh moved_L,
               io::read_surface(prediction / segment_file(kMovedSegment, planned.plan, k)));
    planned.segments_B.push_back(
        geometry::transformed(std::move(moved_L), poses[k].X_LB.inverse()));
    planned.planned_LB.push_back(poses[k].X_LB);
  }
  return planned;
}

}  // namespace

Result<SurgeryFound> find_surgery(const fs::path& prediction, const fs::path& after_ct,
                                  const fs::path& cache, Progress& progress) {
  LEFORT_TRY(PlannedBones planned, read_planned(prediction));
  io::PlanFile options;
  options.segmentation = planned.plan.segmentation;
  LEFORT_TRY(const ScannedHead head, scan_head(options, after_ct, StageCache(cache), progress));
  LEFORT_TRY(const geometry::TriangleMesh skin,
             anatomy::extract_isosurface(
                 anatomy::skin_level(head.scan.ct, head.labels, head.levels), {}, progress));

  progress.begin_stage("register on still bone");
  SurgeryFound found;
  found.scan_sha256 = head.ct_sha256;
  found.warnings = head.scan.warnings;
  const geometry::TriangleMesh base_L =
      compare::unaltered_region(planned.remainder_L, planned.segments_B, kUntouched_mm);
  LEFORT_TRY(found.base,
             compare::register_surface(
                 base_L, geometry::Bvh(head.skull_L),
                 compare::initial_alignments(planned.remainder_L, head.skull_L), {}, progress));
  const RigidTransform X_L_scan = found.base.X_onto_from.inverse();
  found.skin_L = geometry::transformed(skin, X_L_scan);
  found.bone_L = geometry::transformed(head.skull_L, X_L_scan);

  progress.begin_stage("find the movements");
  const geometry::Bvh after_L(found.bone_L);
  double kerf_mm = 0.0;  // Of all: a cut face may be another segment's saw's.
  for (const plan::PlannedSegment& one : planned.plan.segments)
    kerf_mm = std::max(kerf_mm, one.osteotomy.kerf_mm);
  for (std::size_t k = 0; k < planned.segments_B.size(); ++k) {
    const geometry::TriangleMesh& segment_B = planned.segments_B[k];
    std::vector<geometry::TriangleMesh> others_L{planned.remainder_L};
    for (std::size_t other = 0; other < planned.segments_B.size(); ++other)
      if (other != k) others_L.push_back(planned.segments_B[other]);
    const geometry::TriangleMesh dilated_B =
        compare::unaltered_region(segment_B, others_L, kCutFaces_mm + kerf_mm);
    LEFORT_TRY(compare::Registration achieved,
               compare::register_segment(dilated_B, after_L, planned.planned_LB[k], progress));
    found.movements.push_back(
        {planned.plan.segments[k].osteotomy.segment, planned.planned_LB[k], achieved,
         compare::difference_of(RigidTransform::Identity(), achieved.X_onto_from, segment_B),
         compare::difference_of(planned.planned_LB[k], achieved.X_onto_from, segment_B)});
  }
  return found;
}

}  // namespace lefort::pipeline
