#include <lefort/compare/ratio_rule.h>
#include <lefort/compare/register_segment.h>
#include <lefort/compare/surface_difference.h>
#include <lefort/core/units.h>
#include <lefort/core/version.h>
#include <lefort/io/output_folder.h>
#include <lefort/io/sha256.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/predict.h>
#include <lefort/pipeline/validate/run_case.h>
#include <lefort/report/compare_pictures.h>

#include <fmt/format.h>

#include <algorithm>
#include <system_error>
#include <utility>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;
using geometry::TriangleMesh;

// Increase when results of the same inputs change.
constexpr const char* kRevision = "validate-3";

std::string key_of(const CaseJob& job, const std::string& inputs_sha256) {
  const SetupOptions& setup = job.setup;
  return io::Sha256()
      .add(kRevision)
      .add(kVersion)
      .add(inputs_sha256)
      .add(setup.achieved_movements ? 1.0 : 0.0)
      .add(setup.element_size_mm.value_or(0.0))
      .add(setup.voxel_mm)
      .add(job.pictures ? 1.0 : 0.0)
      .hex();
}

/// Whether a stored result is of these inputs and options, and has its pictures.
bool is_current(const CaseJob& job, const CaseResult& stored, const std::string& key) {
  std::error_code error;
  return stored.key == key &&
         std::all_of(stored.pictures.begin(), stored.pictures.end(), [&](const std::string& name) {
           return fs::exists(job.output / "pictures" / name, error);
         });
}

std::vector<SegmentMovement> movements_of(const CaseSetup& setup) {
  std::vector<SegmentMovement> movements;
  for (std::size_t k = 0; k < setup.segments.size(); ++k) {
    const compare::MovementDifference moved = compare::difference_of(
        RigidTransform::Identity(), setup.moved_LB[k], setup.cut.segments_L[k]);
    movements.push_back({setup.segments[k], moved.translation_mm,
                         moved.rotation_rad * degrees_from_radians(1.0), moved.max_mm});
  }
  return movements;
}

TriangleMesh rule_of_thumb(const CaseSetup& setup, const TriangleMesh& skin_L,
                           const std::vector<compare::FaceRegion>& region_of) {
  std::vector<compare::MovedBone> bones;
  for (std::size_t k = 0; k < setup.segments.size(); ++k)
    bones.push_back({&setup.cut.segments_L[k], setup.moved_LB[k]});
  bones.push_back({&setup.cut.remainder_L, RigidTransform::Identity()});
  return compare::apply_ratio_rule(skin_L, region_of, bones);
}

/// Pictures of the difference on the predicted face.
Result<std::vector<std::string>> write_pictures(const CaseComputation& job,
                                                const TriangleMesh& predicted_L,
                                                const compare::SurfaceDifference& difference,
                                                double p95_mm, Progress& progress) {
  std::vector<std::string> names;
  if (!job.has_pictures) return names;
  progress.begin_stage("draw");
  LEFORT_TRY(const auto pictures,
             report::draw_difference(predicted_L, difference.signed_mm, p95_mm, progress));
  LEFORT_TRY_VOID(io::make_output_folder(job.pictures));
  for (const report::ComparePicture& picture : pictures) {
    names.push_back(job.picture_prefix + picture.file);
    LEFORT_TRY_VOID(io::write_text(job.pictures / names.back(), picture.png));
  }
  return names;
}

/// Fills in regions and pictures.
Result<void> compare_case(const CaseComputation& job, const CaseSetup& setup, CaseResult& result,
                          Progress& progress) {
  const fs::path& prediction = job.predict.output;
  progress.begin_stage("compare with the achieved face");
  LEFORT_TRY(const TriangleMesh before_L, io::read_surface(prediction / "skin_before.vtp"));
  LEFORT_TRY(const TriangleMesh predicted_L, io::read_surface(prediction / "predicted_skin.vtp"));
  LEFORT_TRY(const std::vector<compare::FaceRegion> region_of, find_regions(setup, before_L));
  result.regions_from = setup.are_landmarks_found ? "automatic" : "landmarks";
  const geometry::Bvh achieved_L(setup.skin_after_L);
  const compare::SurfaceDifference difference =
      compare::measure_difference(predicted_L, achieved_L);
  const auto predicted = compare::face_error(difference, region_of);
  const auto unchanged = compare::face_error(before_L, region_of, achieved_L);
  result.regions = region_results(
      {predicted, unchanged,
       compare::face_error(rule_of_thumb(setup, before_L, region_of), region_of, achieved_L)});
  if (predicted.front().statistics.compared_fraction == 0.0)
    return fail(ErrorCode::kInvalidArgument,
                "no point of the predicted face has a counterpart after surgery within 20 mm: are "
                "both in the same frame?");
  const auto motion = compare::face_error(before_L, region_of, geometry::Bvh(predicted_L));
  std::size_t r = 0;
  for (RegionResult& region : result.regions) {
    while (unchanged[r].region != region.region) ++r;
    region.achieved_y_mm = -unchanged[r].mean_offset_mm.y();
    region.predicted_y_mm = -motion[r].mean_offset_mm.y();
  }
  LEFORT_TRY(result.pictures, write_pictures(job, predicted_L, difference,
                                             predicted.front().statistics.p95_mm, progress));
  return {};
}

}  // namespace

Result<ComputedCase> predict_and_compare(const CohortCase& one, const CaseComputation& computation,
                                         CaseResult result, Progress& progress) {
  LEFORT_TRY(const CaseSetup setup,
             set_up_case(one, computation.work, computation.setup, progress));
  result.movement = setup.has_achieved_movements ? "achieved" : "plan";
  result.registered_on = setup.registration ? "bone" : "none";
  result.segments = movements_of(setup);
  PredictJob predict = computation.predict;
  predict.plan = setup.plan;
  predict.ct = setup.ct;
  LEFORT_TRY(Summary predicted, predict_case(predict, progress));
  result.regions_from = "none";
  if (one.has_after()) LEFORT_TRY_VOID(compare_case(computation, setup, result, progress));
  return ComputedCase{std::move(result), std::move(predicted.json)};
}

bool is_of_case(const Error& error) {
  return error.code != ErrorCode::kCancelled && error.code != ErrorCode::kFileUnwritable &&
         error.code != ErrorCode::kOutOfMemory;
}

Result<CaseResult> run_case(const CaseJob& job, Progress& progress) {
  CaseResult result;
  result.name = job.folder.filename().string();
  const auto failed = [&](const Error& error) {
    CaseResult failure{.name = result.name, .key = result.key};
    failure.failure = without_paths(error.message, job.cohort, job.output);
    return failure;
  };
  progress.begin_stage("read");
  const Result<CohortCase> one = find_case(job.folder);
  if (!one) return failed(one.error());
  const Result<std::string> inputs_sha256 = fingerprint_case(*one);
  if (!inputs_sha256) return failed(inputs_sha256.error());
  result.key = key_of(job, *inputs_sha256);
  const fs::path work = job.output / "cases" / result.name;
  const fs::path file = work / "result.json";
  if (auto stored = read_case_result(file); stored && is_current(job, *stored, result.key)) {
    progress.note("compared by an earlier run");
    return stored;
  }
  const CaseComputation computation{.setup = job.setup,
                                    .work = work,
                                    .pictures = job.output / "pictures",
                                    .picture_prefix = result.name + "_",
                                    .has_pictures = job.pictures,
                                    .predict = {.plan = {},
                                                .ct = std::nullopt,
                                                .output = work / "prediction",
                                                .pictures = false,
                                                .sensitivity = false}};
  Result<ComputedCase> computed = predict_and_compare(*one, computation, result, progress);
  if (!computed && !is_of_case(computed.error())) return tl::unexpected(computed.error());
  result = computed ? std::move(computed->result) : failed(computed.error());
  LEFORT_TRY_VOID(io::make_output_folder(work));
  LEFORT_TRY_VOID(io::write_text(file, as_json(result).dump(1) + "\n"));
  return result;
}

}  // namespace lefort::pipeline
