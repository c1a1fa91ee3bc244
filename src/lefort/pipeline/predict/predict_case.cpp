#include <lefort/compare/soft_tissue_ratios.h>
#include <lefort/core/units.h>
#include <lefort/core/version.h>
#include <lefort/io/deprecated_keys.h>
#include <lefort/io/output_folder.h>
#include <lefort/io/plan_file.h>
#include <lefort/io/plan_inputs.h>
#include <lefort/io/sha256.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/cache/restart_file.h>
#include <lefort/pipeline/json/prediction_json.h>
#include <lefort/pipeline/predict.h>
#include <lefort/pipeline/predict/interface_sensitivity.h>
#include <lefort/pipeline/predict/prediction_pictures.h>
#include <lefort/pipeline/predict/prediction_report.h>
#include <lefort/pipeline/predict/ratio_results.h>
#include <lefort/pipeline/predict/write_prediction.h>
#include <lefort/pipeline/prepare/find_head_landmarks.h>
#include <lefort/pipeline/prepare/prepare_case.h>
#include <lefort/pipeline/timing/peak_memory.h>
#include <lefort/pipeline/timing/stage_timer.h>
#include <lefort/predict/embed_skin.h>
#include <lefort/predict/predict_face.h>
#include <lefort/predict/skin_displacement.h>
#include <lefort/predict/tissue_boundary.h>

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <iterator>
#include <optional>
#include <span>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;

/// Reports each step and measures its time.
class StepClock {
 public:
  explicit StepClock(Progress& progress) : progress_(progress) {}

  void operator()(const predict::PredictionStep& step) {
    const auto now = std::chrono::steady_clock::now();
    seconds_.push_back(std::chrono::duration<double>(now - last_).count());
    last_ = now;
    const contact::ContactStatistics contact = step.contact();
    progress_.note(fmt::format(
        "  {:5.1f} % of the path: {} Newton iterations in {} increments, relative residual {:.1e}, "
        "{} nodes in contact, penetration increase P99 {:.3f} mm, max {:.3f} mm, {:.1f} s",
        100.0 * step.path_fraction, step.newton_iterations(), step.attempts.size(),
        step.relative_residual, contact.nodes, contact.p99_penetration_increase_mm,
        contact.max_penetration_increase_mm, seconds_.back()));
  }
  [[nodiscard]] const std::vector<double>& seconds() const { return seconds_; }

 private:
  Progress& progress_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
  std::vector<double> seconds_;
};

/// Writes the restart file after each step. A failure is reported once.
class RestartWriter {
 public:
  RestartWriter(fs::path path, Progress& progress) : path_(std::move(path)), progress_(&progress) {}

  void operator()(const predict::Restart& restart) {
    if (!is_writable_) return;
    const Result<void> written = write_restart(path_, restart);
    is_writable_ = written.has_value();
    if (!is_writable_)
      progress_->note(fmt::format("the restart file is not written: {}", written.error().message));
  }

 private:
  fs::path path_;
  Progress* progress_;
  bool is_writable_ = true;
};

/// Steps that an earlier run of the same case computed, if there was one.
std::optional<predict::Restart> find_earlier(const fs::path& file, int steps, Progress& progress) {
  std::error_code error;
  if (!fs::exists(file, error)) return std::nullopt;
  progress.begin_stage("read steps from the cache");
  Result<predict::Restart> found = read_restart(file);
  if (!found) {
    progress.note(fmt::format("{}; all steps are computed again", found.error().message));
    return std::nullopt;
  }
  progress.note(
      fmt::format("{} of {} steps were computed by an earlier run", found->steps.size(), steps));
  return *std::move(found);
}

/// Detection method and contact pressure.
void report_contact(const io::PlanFile& plan, Progress& progress) {
  if (plan.boundary.interface == predict::TissueInterface::kBonded) return;
  const contact::PressureLaw law = predict::contact_law(plan.contact, plan.tissue);
  progress.note(fmt::format(
      "contact: {} detection, k_c = {:.4g} kPa/mm ({:g} times Young's modulus, {:g} kPa, over the "
      "node spacing, {:g} mm){}{}",
      contact::name_of(plan.contact.detection), kpa_from_mpa(law.penalty_mpa_per_mm),
      predict::stiffness_factor(plan.contact, plan.tissue), kpa_from_mpa(plan.tissue.young_mpa),
      predict::node_spacing_mm(plan.tissue),
      law.hardening_mpa_per_mm2 > 0.0
          ? fmt::format(", penetration tolerance {:g} mm", *plan.contact.penetration_tolerance_mm)
          : "",
      plan.contact.integration == contact::Integration::kWeighted ? ", by weighted gaps" : ""));
}

/// The plan's text, and the scan it is for.
struct LoadedPlan {
  io::PlanText text;
  fs::path ct;
};

StageCache cache_of(const PredictJob& job) {
  return job.shared_cache ? StageCache(*job.shared_cache) : StageCache(job.output / "cache");
}

Result<LoadedPlan> load_plan(const PredictJob& job, const StageCache& cache, Progress& progress) {
  LEFORT_TRY(io::PlanText text, read_plan_of_scan(job.plan, job.ct, cache, progress));
  io::note_warnings(text.plan.warnings, progress);
  if (job.teeth) {
    LEFORT_TRY(text, io::parse_completed_plan(job.plan, io::with_teeth(text.json, *job.teeth)));
  }
  LEFORT_TRY(fs::path ct, io::scan_of(job.plan, text.plan, job.ct));
  return LoadedPlan{std::move(text), std::move(ct)};
}

/// \returns kPlanInvalid if a file that the plan names changes meanwhile, or what prepare_case()
///   returns.
Result<PreparedCase> prepare_prediction(const PredictJob& job, const LoadedPlan& loaded,
                                        const StageCache& cache, Progress& progress) {
  const std::string& text = loaded.text.json;
  LEFORT_TRY(const std::vector<io::InputFile> plan_files, io::fingerprints(text, job.plan));
  LEFORT_TRY(PreparedCase prepared, prepare_case(loaded.text.plan, io::Sha256().add(text).hex(),
                                                 loaded.ct, cache, progress));
  LEFORT_TRY(prepared.provenance.plan_files, io::fingerprints(text, job.plan));
  if (prepared.provenance.plan_files != plan_files)
    return fail(ErrorCode::kPlanInvalid,
                "a file that the plan names was changed while it was read: predict again");
  return prepared;
}

struct SolvedPath {
  predict::FacePrediction prediction;
  std::vector<double> step_seconds;
};

/// Follows the paths, from where an earlier run of the same case was stopped.
Result<SolvedPath> solve_path(const PredictJob& job, const PreparedCase& prepared,
                              const StageCache& cache, Progress& progress) {
  const fs::path restart = cache.private_file("steps.restart", restart_key(prepared));
  const int steps = prepared.steps();
  std::optional<predict::Restart> earlier = find_earlier(restart, steps, progress);
  progress.begin_stage("solve");
  report_contact(prepared.plan, progress);
  StepClock clock(progress);
  predict::PredictionWatch watch{.on_iterate = {},
                                 .on_step =
                                     [&](const predict::PredictionStep& step) {
                                       clock(step);
                                       if (job.on_step) job.on_step(step, steps);
                                     },
                                 .on_restart = RestartWriter(restart, progress)};
  if (earlier) {
    for (const predict::PredictionStep& step : earlier->steps)
      if (job.on_step) job.on_step(step, steps);
    progress.report(earlier->stepper.last.t);
  }
  if (job.on_iterate)
    watch.on_iterate = [&](const predict::PredictionIterate& at) { job.on_iterate(at, steps); };
  LEFORT_TRY(predict::FacePrediction prediction,
             predict::predict_face(prepared.model, prepared.paths(),
                                   {prepared.plan.tissue, prepared.plan.boundary,
                                    prepared.plan.contact, prepared.plan.solver},
                                   watch, progress, std::move(earlier)));
  return SolvedPath{std::move(prediction), clock.seconds()};
}

/// Writes timing.json if the times are separate.
///
/// \returns the times for the other documents; nothing if they are separate.
Result<std::optional<Timing>> place_timing(const PredictJob& job, Timing timing) {
  if (!job.separate_timing) return timing;
  nlohmann::ordered_json json{
      {"lefort_timing", 1}, {"notice", kNotForClinicalUse}, {"version", kVersion}};
  json.update(timing_json(timing));
  LEFORT_TRY_VOID(io::write_text(job.output / "timing.json", json.dump(1) + "\n"));
  return std::nullopt;
}

/// Writes the solver's history, and no face.
Result<Summary> write_unconverged(const PredictJob& job, const PreparedCase& prepared,
                                  const SolvedPath& solved, const std::string& plan_text,
                                  const std::vector<std::pair<std::string, double>>& stages) {
  const predict::FacePrediction& prediction = solved.prediction;
  LEFORT_TRY(const auto timing, place_timing(job, {stages, solved.step_seconds}));
  LEFORT_TRY_VOID(write_failure(job.output, prediction_report(prepared, prediction, {}, {}, timing),
                                plan_text, prediction_json(prepared, prediction, {}, timing)));
  return fail(prediction.failure->code,
              fmt::format("{} of {} steps converged, then {}; no face is written, the solver's "
                          "history is in {}",
                          prediction.steps.size(), prepared.steps(), prediction.failure->message,
                          (job.output / "failure.json").string()));
}

std::vector<Vec3> displace_skin(const PreparedCase& prepared, const predict::PredictionStep& last) {
  return predict::skin_displacement(
      predict::embed_skin(
          prepared.skin_L, prepared.model.tissue,
          predict::embedding_distance_mm(prepared.plan.tissue, prepared.scan_grid.spacing_mm)),
      last.displacement_mm);
}

/// Ratios of the movement of the skin to that of each segment.
std::vector<compare::SoftTissueRatio> measure_ratios(const PreparedCase& prepared,
                                                     const predict::PredictionStep& last,
                                                     std::span<const Vec3> skin_mm) {
  std::vector<RigidTransform> X_LB;
  for (const predict::SegmentStep& segment : last.segments) X_LB.push_back(segment.X_LB);
  return compare::soft_tissue_ratios(prepared.skin_L, skin_mm,
                                     {prepared.plan.segments, prepared.cut, X_LB},
                                     prepared.plan.landmarks);
}

/// The ratios of the prediction, with those of both interfaces of the sensitivity.
std::vector<ExplainedRatio> explain_ratios(const PreparedCase& prepared,
                                           const predict::PredictionStep& last,
                                           std::span<const Vec3> skin_mm,
                                           const std::optional<InterfaceSensitivity>& sensitivity) {
  std::vector<compare::SoftTissueRatio> attached, contact;
  if (sensitivity && !sensitivity->failure) {
    attached = measure_ratios(prepared, last, sensitivity->attached_mm);
    contact = measure_ratios(prepared, last, sensitivity->contact_mm);
  }
  std::vector<ExplainedRatio> explained =
      with_interfaces(measure_ratios(prepared, last, skin_mm), attached, contact);
  std::vector<Vec3> scan_boundary_L;
  const mesh::VolumeMesh& tissue = prepared.model.tissue;
  for (const std::int32_t node : tissue.node_sets.at(predict::sets::kScanBoundary))
    scan_boundary_L.push_back(tissue.nodes_L[std::size_t(node)]);
  measure_scan_boundary(explained, prepared.plan.landmarks, scan_boundary_L);
  return explained;
}

/// Warns of penetration beyond its limits at the end of the path.
void note_penetration(const predict::PredictionStep& last, Progress& progress) {
  constexpr contact::PenetrationLimits kLimits;
  const contact::ContactStatistics contact = last.contact_of_all_bones();
  if (contact::is_within(kLimits, contact)) return;
  progress.note(fmt::format(
      "warning: at the end of the path the penetration increase is P99 {:.2f} mm, max {:.2f} mm, "
      "more than the limits of {:g} and {:g} mm; contact.stiffness_factor or smaller elements "
      "reduce it",
      contact.p99_penetration_increase_mm, contact.max_penetration_increase_mm, kLimits.p99_mm,
      kLimits.max_mm));
}

Result<Summary> write_face(const PredictJob& job, const PreparedCase& prepared,
                           const SolvedPath& solved, const std::string& plan_text,
                           const StageCache& cache, StageTimer& progress) {
  const predict::FacePrediction& prediction = solved.prediction;
  const predict::PredictionStep& last = prediction.steps.back();
  const std::vector<Vec3> skin_mm = displace_skin(prepared, last);
  const predict::SkinDisplacementStatistics skin = predict::measure_skin_displacement(skin_mm);
  std::optional<InterfaceSensitivity> sensitivity;
  if (job.sensitivity) {
    LEFORT_TRY(sensitivity, measure_interface_sensitivity(prepared, cache, progress));
    progress.note(fmt::format("{} versus contact interface, coarse mesh: {}",
                              name_of(sensitivity->attached), in_words(*sensitivity)));
  }
  const std::vector<ExplainedRatio> ratios = explain_ratios(prepared, last, skin_mm, sensitivity);
  std::vector<PredictionPicture> pictures;
  if (job.pictures) {
    progress.begin_stage("draw");
    LEFORT_TRY(pictures, draw_prediction(prepared, skin_mm, last.segments, progress));
  }
  progress.begin_stage("write");
  LEFORT_TRY_VOID(write_surfaces_and_fields(job.output, prepared, prediction, skin_mm));
  if (job.paraview) LEFORT_TRY_VOID(write_paraview(job.output, prepared, prediction));
  LEFORT_TRY(const auto timing, place_timing(job, {progress.stages(), solved.step_seconds}));
  auto json = prediction_json(prepared, prediction, skin, timing);
  json["interface_sensitivity"] =
      sensitivity ? as_json(*sensitivity) : nlohmann::ordered_json(nullptr);
  report::CaseReport report = prediction_report(prepared, prediction, pictures, skin, timing);
  if (sensitivity) report.tables.insert(report.tables.begin(), as_table(*sensitivity));
  json["soft_tissue_ratios"] = ratios_json(ratios);
  std::vector<report::ReportTable> tables = ratio_tables(ratios);
  report.tables.insert(report.tables.begin(), std::make_move_iterator(tables.begin()),
                       std::make_move_iterator(tables.end()));
  LEFORT_TRY_VOID(write_documents(job.output, report, pictures, prepared.quality, plan_text, json));
  note_penetration(last, progress);
  Summary summary;
  summary.text = fmt::format(
      "{}: skin moved up to {:.2f} mm, {} steps converged, {} elements, {:.0f} MB at most",
      job.output.string(), skin.max_mm, prediction.steps.size(),
      prepared.model.tissue.element_count(), peak_memory_mb());
  summary.json = json;
  return summary;
}

}  // namespace

Result<Summary> predict_case(const PredictJob& job, Progress& inner) {
  StageTimer progress(inner);
  const StageCache cache = cache_of(job);
  LEFORT_TRY(const LoadedPlan loaded, load_plan(job, cache, progress));
  const io::EmptyFolderCleanup cleanup(job.output);
  LEFORT_TRY_VOID(io::make_output_folder(job.output));
  LEFORT_TRY_VOID(remove_results(job.output));
  const std::string plan_text =
      io::portable_plan(loaded.text.json, job.plan, loaded.ct, job.output);

  LEFORT_TRY(const PreparedCase prepared, prepare_prediction(job, loaded, cache, progress));
  LEFORT_TRY_VOID(write_overlaps(job.output, prepared));

  LEFORT_TRY(const SolvedPath solved, solve_path(job, prepared, cache, progress));
  if (!solved.prediction.converged())
    return write_unconverged(job, prepared, solved, plan_text, progress.stages());
  return write_face(job, prepared, solved, plan_text, cache, progress);
}

}  // namespace lefort::pipeline
