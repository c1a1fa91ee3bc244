#include <lefort/core/units.h>
#include <lefort/io/deprecated_keys.h>
#include <lefort/io/output_folder.h>
#include <lefort/io/plan_file.h>
#include <lefort/io/plan_inputs.h>
#include <lefort/io/sha256.h>
#include <lefort/pipeline/cache/restart_file.h>
#include <lefort/pipeline/json/prediction_json.h>
#include <lefort/pipeline/predict.h>
#include <lefort/pipeline/predict/prediction_pictures.h>
#include <lefort/pipeline/predict/prediction_report.h>
#include <lefort/pipeline/predict/write_prediction.h>
#include <lefort/pipeline/prepare/prepare_case.h>
#include <lefort/pipeline/timing/peak_memory.h>
#include <lefort/pipeline/timing/stage_timer.h>
#include <lefort/predict/embed_skin.h>
#include <lefort/predict/predict_face.h>

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;

SkinShift measure_skin_shift(const std::vector<Vec3>& displacement_mm) {
  constexpr double kMoved_mm = 0.5;
  SkinShift shift;
  Index moved = 0;
  for (const Vec3& u : displacement_mm) {
    const double length_mm = u.norm();
    shift.max_mm = std::max(shift.max_mm, length_mm);
    if (length_mm <= kMoved_mm) continue;
    shift.mean_over_moved_mm += length_mm;
    ++moved;
  }
  if (moved > 0) shift.mean_over_moved_mm /= double(moved);
  return shift;
}

/// Tells each step and remembers how long it took.
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
        "{} nodes in contact, depth P99 {:.3f} mm, at most {:.3f} mm, {:.1f} s",
        100.0 * step.path_fraction, step.newton_iterations(), step.attempts.size(),
        step.relative_residual, contact.nodes, contact.p99_depth_from_rest_mm,
        contact.max_depth_from_rest_mm, seconds_.back()));
  }
  [[nodiscard]] const std::vector<double>& seconds() const { return seconds_; }

 private:
  Progress& progress_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
  std::vector<double> seconds_;
};

/// Keeps what is found, step by step; that it cannot is told once.
class StepKeeper {
 public:
  StepKeeper(fs::path path, Progress& progress) : path_(std::move(path)), progress_(&progress) {}

  void operator()(const predict::Restart& restart) {
    if (!is_kept_) return;
    const Result<void> kept = write_restart(path_, restart);
    is_kept_ = kept.has_value();
    if (!is_kept_)
      progress_->note(fmt::format("steps are not kept for another run: {}", kept.error().message));
  }

 private:
  fs::path path_;
  Progress* progress_;
  bool is_kept_ = true;
};

/// What an earlier run of the same has found, if it was stopped, or is run again.
std::optional<predict::Restart> find_earlier(const fs::path& kept, int steps, Progress& progress) {
  std::error_code error;
  if (!fs::exists(kept, error)) return std::nullopt;
  progress.begin_stage("read steps from the cache");
  Result<predict::Restart> found = read_restart(kept);
  if (!found) {
    progress.note(fmt::format("{}; the path is followed anew", found.error().message));
    return std::nullopt;
  }
  progress.note(
      fmt::format("{} of {} steps were found by an earlier run", found->steps.size(), steps));
  return *std::move(found);
}

/// What contact is found and held by.
void report_contact(const io::PlanFile& plan, Progress& progress) {
  if (plan.boundary.segment_interface != predict::SegmentInterface::kSliding) return;
  const auto& tolerance_mm = plan.contact.penetration_tolerance_mm;
  progress.note(fmt::format(
      "contact: {} detection, k_c = {:.4g} kPa/mm ({:g} times Young's modulus, {:g} kPa, over the "
      "element size, {:g} mm){}",
      contact::name_of(plan.contact.detection),
      kpa_from_mpa(predict::contact_stiffness_mpa_per_mm(plan.tissue, plan.contact)),
      predict::stiffness_factor(plan.contact), kpa_from_mpa(plan.tissue.young_mpa),
      plan.tissue.element_size_mm,
      tolerance_mm ? fmt::format(", multipliers until the P99 of depth is {:g} mm", *tolerance_mm)
                   : ""));
}

/// A path that could not be followed leaves its history, and no face.
Result<Summary> give_up(const PredictJob& job, const PreparedCase& prepared,
                        const predict::FacePrediction& prediction, const std::string& plan_text,
                        const Timing& timing) {
  LEFORT_TRY_VOID(write_failure(job.output, prediction_report(prepared, prediction, {}, {}, timing),
                                plan_text, prediction_json(prepared, prediction, {}, timing)));
  return fail(prediction.failure->code,
              fmt::format("{} of {} steps converged, then {}; no face is written, the solver's "
                          "history is in {}",
                          prediction.steps.size(), prepared.steps(), prediction.failure->message,
                          (job.output / "failure.json").string()));
}

}  // namespace

Result<Summary> predict_case(const PredictJob& job, Progress& shown) {
  StageTimer progress(shown);
  LEFORT_TRY(const io::PlanText text, io::read_plan_text(job.plan));
  io::PlanFile plan = text.plan;
  io::note_warnings(plan.warnings, progress);
  LEFORT_TRY(const fs::path ct, io::scan_of(job.plan, plan, job.ct));
  const io::EmptyFolderCleanup none_left(job.output);
  LEFORT_TRY_VOID(io::make_output_folder(job.output));
  LEFORT_TRY_VOID(remove_results(job.output));
  const std::string plan_copy = io::portable_plan(text.json, job.plan, ct, job.output);

  const StageCache cache(job.output / "cache");
  LEFORT_TRY(const std::vector<io::InputFile> plan_files, io::fingerprints(text.json, job.plan));
  LEFORT_TRY(PreparedCase prepared,
             prepare_case(std::move(plan), io::Sha256().add(text.json).hex(), ct, cache, progress));

  LEFORT_TRY(prepared.provenance.plan_files, io::fingerprints(text.json, job.plan));
  if (prepared.provenance.plan_files != plan_files)
    return fail(ErrorCode::kPlanInvalid,
                "a file that the plan names was changed while it was read: predict again");

  LEFORT_TRY_VOID(write_overlaps(job.output, prepared));

  const fs::path kept = cache.file("steps.restart", restart_key(prepared));
  const int steps = prepared.steps();
  std::optional<predict::Restart> earlier = find_earlier(kept, steps, progress);
  progress.begin_stage("solve");
  report_contact(prepared.plan, progress);
  StepClock clock(progress);
  predict::PredictionWatch watch{.on_iterate = {},
                                 .on_step =
                                     [&](const predict::PredictionStep& step) {
                                       clock(step);
                                       if (job.on_step) job.on_step(step, steps);
                                     },
                                 .on_restart = StepKeeper(kept, progress)};
  if (earlier) {  // Those who watch see at once how far it is.
    for (const predict::PredictionStep& step : earlier->steps)
      if (job.on_step) job.on_step(step, steps);
    progress.report(earlier->stepper.last.t);
  }
  if (job.on_iterate)
    watch.on_iterate = [&](const predict::PredictionIterate& at) { job.on_iterate(at, steps); };
  LEFORT_TRY(const predict::FacePrediction prediction,
             predict::predict_face(prepared.model, prepared.paths(),
                                   {prepared.plan.tissue, prepared.plan.boundary,
                                    prepared.plan.contact, prepared.plan.solver},
                                   watch, progress, std::move(earlier)));
  if (!prediction.converged())
    return give_up(job, prepared, prediction, plan_copy, {progress.stages(), clock.seconds()});

  if (const auto& tolerance_mm = prepared.plan.contact.penetration_tolerance_mm)
    if (const auto deep = std::count_if(prediction.steps.begin(), prediction.steps.end(),
                                        [&](const auto& step) {
                                          return step.contact().p99_depth_from_rest_mm >
                                                 *tolerance_mm;
                                        });
        deep > 0)
      progress.note(
          fmt::format("warning: after {} of {} steps tissue in contact lies deeper (P99) than "
                      "contact.penetration_tolerance_mm = {:g} mm; multipliers got no further",
                      deep, prediction.steps.size(), *tolerance_mm));
  const predict::PredictionStep& last = prediction.steps.back();
  const std::vector<Vec3> skin_mm = predict::skin_displacement(
      predict::embed_skin(
          prepared.skin_L, prepared.model.tissue,
          predict::embedding_distance_mm(prepared.plan.tissue, prepared.scan_grid.spacing_mm)),
      last.displacement_mm);
  const SkinShift skin = measure_skin_shift(skin_mm);
  std::vector<PredictionPicture> pictures;
  if (job.pictures) {
    progress.begin_stage("draw");
    LEFORT_TRY(pictures, draw_prediction(prepared, skin_mm, last.segments, progress));
  }
  progress.begin_stage("write");
  LEFORT_TRY_VOID(write_surfaces_and_fields(job.output, prepared, prediction, skin_mm));
  const Timing timing{progress.stages(), clock.seconds()};
  const auto json = prediction_json(prepared, prediction, skin, timing);
  LEFORT_TRY_VOID(write_documents(job.output,
                                  prediction_report(prepared, prediction, pictures, skin, timing),
                                  pictures, prepared.quality, plan_copy, json));

  Summary summary;
  summary.text = fmt::format(
      "{}: skin moved up to {:.2f} mm, {} steps converged, {} elements, {:.0f} MB at most",
      job.output.string(), skin.max_mm, prediction.steps.size(),
      prepared.model.tissue.element_count(), peak_memory_mb());
  summary.json = json;
  return summary;
}

}  // namespace lefort::pipeline
