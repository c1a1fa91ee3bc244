#include <lefort/anatomy/extract_surface.h>
#include <lefort/anatomy/tissue_levels.h>
#include <lefort/geometry/transform_mesh.h>
#include <lefort/io/plan_file.h>
#include <lefort/io/predicted_poses.h>
#include <lefort/io/read_text.h>
#include <lefort/io/surface_files.h>
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

/// Bones of a plan, and the thresholds of its segmentation.
struct PredictedBones {
  compare::PlannedBones bones;
  anatomy::SegmentationOptions segmentation;
};

bool is_file(const fs::path& file) {
  std::error_code error;
  return fs::is_regular_file(file, error);
}

/// Poses after the last step of the prediction. They are not computed from plan.json: files that it
/// names may have changed.
Result<std::vector<io::SegmentPose>> final_poses(const fs::path& file) {
  constexpr std::uintmax_t kMaxBytes = 256 << 20;
  LEFORT_TRY(const std::string text, io::read_text(file, kMaxBytes));
  const auto document = nlohmann::json::parse(text, nullptr, false);
  const auto steps = document.find("steps");
  auto poses = steps != document.end() && steps->is_array() && !steps->empty()
                   ? io::predicted_poses(document, steps->back())
                   : fail(ErrorCode::kFileCorrupt, "the prediction has no steps");
  if (!poses)
    return fail(poses.error().code, fmt::format("{}: {}", file.string(), poses.error().message));
  return poses;
}

Result<PredictedBones> read_planned(const fs::path& prediction) {
  if (!is_file(prediction / "prediction.json") || !is_file(prediction / "plan.json"))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{} is not the folder of a finished prediction: it has no "
                            "prediction.json",
                            prediction.string()));
  LEFORT_TRY(const io::PlanFile plan, io::read_plan(prediction / "plan.json"));
  PredictedBones planned{{}, plan.segmentation};
  compare::PlannedBones& bones = planned.bones;
  LEFORT_TRY(const std::vector<io::SegmentPose> poses, final_poses(prediction / "prediction.json"));
  LEFORT_TRY(bones.remainder_L, io::read_surface(prediction / "bone_remainder.vtp"));
  if (poses.size() != plan.segments.size())
    return fail(ErrorCode::kFileCorrupt,
                fmt::format("plan.json and prediction.json in {} are of different plans",
                            prediction.string()));
  for (std::size_t k = 0; k < poses.size(); ++k) {
    LEFORT_TRY(geometry::TriangleMesh moved_L,
               io::read_surface(prediction / segment_file(kMovedSegment, plan, k)));
    bones.segments.push_back(plan.segments[k].osteotomy.segment);
    bones.segments_B.push_back(geometry::transformed(std::move(moved_L), poses[k].X_LB.inverse()));
    bones.planned_LB.push_back(poses[k].X_LB);
    bones.kerf_mm = std::max(bones.kerf_mm, plan.segments[k].osteotomy.kerf_mm);
  }
  return planned;
}

}  // namespace

Result<SurgeryFound> find_surgery(const fs::path& prediction, const fs::path& after_ct,
                                  const fs::path& cache, Progress& progress) {
  LEFORT_TRY(const PredictedBones planned, read_planned(prediction));
  io::PlanFile options;
  options.segmentation = planned.segmentation;
  LEFORT_TRY(const ScannedHead head, scan_head(options, after_ct, StageCache(cache), progress));
  LEFORT_TRY(const geometry::TriangleMesh skin,
             anatomy::extract_isosurface(
                 anatomy::skin_level(head.scan.ct, head.labels, head.levels), {}, progress));

  progress.begin_stage("register on stationary bone");
  SurgeryFound found;
  found.scan_sha256 = head.ct_sha256;
  found.warnings = head.scan.warnings;
  LEFORT_TRY(found.base, compare::register_remainder(planned.bones, head.skull_L, progress));
  const RigidTransform X_L_scan = found.base.X_onto_from.inverse();
  found.skin_L = geometry::transformed(skin, X_L_scan);
  found.bone_L = geometry::transformed(head.skull_L, X_L_scan);

  progress.begin_stage("find the movements");
  LEFORT_TRY(found.movements, compare::recover_movements(planned.bones, found.bone_L, progress));
  return found;
}

}  // namespace lefort::pipeline
