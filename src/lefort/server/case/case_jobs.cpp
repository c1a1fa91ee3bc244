#include <lefort/io/plan_file.h>
#include <lefort/io/sha256.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/compare.h>
#include <lefort/pipeline/import.h>
#include <lefort/pipeline/plan.h>
#include <lefort/pipeline/predict.h>
#include <lefort/pipeline/segment.h>
#include <lefort/pipeline/uncertainty.h>
#include <lefort/server/api/contract_text.h>
#include <lefort/server/case/case_jobs.h>
#include <lefort/server/case/event_batcher.h>
#include <lefort/server/case/file_catalog.h>
#include <lefort/server/case/job_parts.h>
#include <lefort/server/case/measure_jobs.h>
#include <lefort/server/case/measure_stages.h>
#include <lefort/server/case/variants.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

namespace lefort::server {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

using Doer = Result<JobOutcome> (*)(const JobContext&, const JobRecord&, Progress&);

Result<JobOutcome> import_job(const JobContext& context, const JobRecord& job, Progress& progress) {
  CaseFolder& folder = context.folder;
  std::error_code error;
  fs::remove_all(folder.import_folder(), error);
  fs::create_directory(folder.import_folder(), error);
  const fs::path ct = folder.import_folder() / folder.ct().filename();
  pipeline::ImportJob import{{}, ct, job.parameters.value("series", 0)};
  const bool is_example = job.parameters.contains("example");
  const std::string upload = job.parameters.value("upload", "");
  std::optional<Uploads::Source> source;
  if (is_example) {
    if (!context.example)
      return fail(ErrorCode::kFileNotFound,
                  "the example's scan is not installed (Debian's invesalius-examples)");
    import.source = *context.example;
  } else {
    source = context.uploads.source(upload);
    if (!source) return fail(ErrorCode::kFileNotFound, "no such upload, or the upload is empty");
    import.source = source->path();
  }
  LEFORT_TRY(pipeline::Summary summary, pipeline::import_scan(import, progress));
  LEFORT_TRY(const std::string ct_sha256, io::sha256_of_file(ct));
  const json description{{"lefort_case", 1},
                         {"ct_sha256", ct_sha256},
                         {"title", is_example ? "Example: Cranium of InVesalius" : ""},
                         {"scan",
                          {{"source_kind", summary.json["source_kind"]},
                           {"size", summary.json["size_voxels"]},
                           {"spacing_mm", summary.json["spacing_mm"]},
                           {"warnings", summary.json["warnings"]}}}};
  LEFORT_TRY_VOID(io::write_text(folder.import_folder() / folder.description().filename(),
                                 description.dump(1) + "\n"));
  LEFORT_TRY_VOID(folder.replace_scan(folder.import_folder()));
  if (const std::size_t at = summary.text.find(ct.string()); at != std::string::npos)
    summary.text.replace(at, ct.string().size(), folder.ct().string());
  if (is_example && !fs::exists(folder.landmarks(), error)) {
    LEFORT_TRY_VOID(io::write_text(folder.landmarks(), kExampleLandmarks));
    LEFORT_TRY_VOID(folder.record_scan("landmarks"));
  }
  if (!is_example) static_cast<void>(context.uploads.remove(upload));
  return reported(summary);
}

Result<JobOutcome> segment_job(const JobContext& context, const JobRecord& job,
                               Progress& progress) {
  CaseFolder& folder = context.folder;
  LEFORT_TRY_VOID(check_scan(folder));
  pipeline::SegmentJob segment{
      .ct = folder.ct(), .output = folder.anatomy(), .options = {}, .finish = {}, .labels = {}};
  if (there_is(folder.plan())) {  // Thresholds are the plan's unless given.
    LEFORT_TRY_VOID(check_plan(folder));
    if (const auto open = io::read_open_plan(folder.plan()); open && *open)
      segment.options = (*open)->plan.segmentation;
    else if (const auto plan = io::read_plan(folder.plan()))
      segment.options = plan->segmentation;
  }
  segment.options.bone_hu = job.parameters.value("bone_hu", segment.options.bone_hu);
  segment.options.skin_hu = job.parameters.value("skin_hu", segment.options.skin_hu);
  if (job.parameters.value("from_labels", false)) {
    if (!there_is(folder.labels())) return fail(ErrorCode::kFileNotFound, "the case has no labels");
    segment.labels = folder.labels();
  }
  LEFORT_TRY(const pipeline::Summary summary, pipeline::segment_scan(segment, progress));
  if (const auto inputs = folder.inputs_of("anatomy"))
    LEFORT_TRY_VOID(folder.record_inputs("anatomy", *inputs));
  return reported(summary);
}

/// Finds landmarks and returns them; the file of the case is changed by pages only, where a user
/// sees what is placed and can undo it.
Result<JobOutcome> landmarks_job(const JobContext& context, const JobRecord&, Progress& progress) {
  const CaseFolder& folder = context.folder;
  LEFORT_TRY_VOID(check_scan(folder));
  pipeline::LandmarksJob landmarks;
  landmarks.find = folder.ct();
  landmarks.labels = labels_of_scan(folder);
  LEFORT_TRY(const pipeline::Summary summary, pipeline::measure_landmarks(landmarks, progress));
  const json& search = summary.json["search"];
  return JobOutcome{fmt::format("{} landmarks found", search["found"].size()),
                    {{"found", search["found"]}, {"missing", search["missing"]}}};
}

/// Runs `work` and stores the fingerprints of its inputs. The documents of earlier results are
/// removed first: `work` can fail before it removes them, and they would be taken for new ones.
template <class Work>
Result<JobOutcome> as_stage(CaseFolder& folder, std::string_view stage, Progress& progress,
                            const Work& work) {
  LEFORT_TRY_VOID(check_plan(folder));
  note_other_scans(folder, progress);
  LEFORT_TRY_VOID(folder.forget_result(stage));
  auto inputs = folder.inputs_of(stage);
  if (inputs) LEFORT_TRY_VOID(folder.record_inputs(stage, *inputs));
  Result<JobOutcome> outcome = work();
  if (const auto now = folder.inputs_of(stage); inputs && now != inputs)
    LEFORT_TRY_VOID(folder.record_inputs(stage, inputs_read(*std::move(inputs), now)));
  return outcome;
}

Result<JobOutcome> cut_job(const JobContext& context, const JobRecord&, Progress& progress) {
  CaseFolder& folder = context.folder;
  return as_stage(folder, "cut", progress, [&]() -> Result<JobOutcome> {
    LEFORT_TRY(
        const pipeline::Summary summary,
        pipeline::cut_plan({folder.plan(), folder.ct(), folder.cache(), folder.cut()}, progress));
    return reported(summary);
  });
}

/// The canals of the case unless they are out of date, which is noted.
std::optional<fs::path> nerve_of_check(const CaseFolder& folder, Progress& progress) {
  const std::string state = folder.stage("nerve")["state"];
  if (state == "stale")
    progress.note(
        "warning: the canals of the nerves are out of date; the check does not include them");
  if (state == "missing")
    progress.note("no canals of the nerves are known; the check does not include them");
  if (state != "fresh") return std::nullopt;
  return folder.nerve() / "nerve.json";
}

/// The splints and guides of the case that are up to date, for the worksheet.
std::vector<pipeline::PrintedPart> printed_parts(const CaseFolder& folder) {
  std::vector<pipeline::PrintedPart> parts;
  for (const char* stage : {"splint_intermediate", "splint_final"})
    if (folder.stage(stage)["state"] == "fresh")
      parts.push_back({"splint", folder_of_measure(folder, stage) / "splint.stl",
                       fmt::format("{}.stl", stage)});
  if (folder.stage("guides")["state"] != "fresh") return parts;
  const json guides = read_object(folder.guides() / "guides.json");
  if (const auto list = guides.find("guides"); list != guides.end() && list->is_array())
    for (const json& one : *list) {
      if (!one.is_object() || !one.contains("name") || !one["name"].is_string()) continue;
      std::string name = fmt::format("guide_{}.stl", one["name"].get<std::string>());
      if (const auto file = guide_result(folder, name); file && there_is(*file))
        parts.push_back({"guide", *file, std::move(name)});
    }
  return parts;
}

Result<JobOutcome> check_job(const JobContext& context, const JobRecord&, Progress& progress) {
  CaseFolder& folder = context.folder;
  // Before the earlier check is removed, on which the intermediate splint depends.
  const std::vector<pipeline::PrintedPart> printed = printed_parts(folder);
  return as_stage(folder, "check", progress, [&]() -> Result<JobOutcome> {
    pipeline::CheckPlanJob check{.plan = folder.plan(),
                                 .ct = folder.ct(),
                                 .skull = {},
                                 .output = folder.check(),
                                 .cache = folder.cache(),
                                 .limits = {},
                                 .pictures = false};
    check.nerve = nerve_of_check(folder, progress);
    check.tooth_corrections = tooth_corrections(folder);
    check.printed = printed;
    LEFORT_TRY(const pipeline::PlanCheckSummary found, pipeline::check_plan_file(check, progress));
    JobOutcome outcome = reported(found.summary);
    outcome.has_findings = found.has_findings;
    return outcome;
  });
}

Result<JobOutcome> preview_job(const JobContext& context, const JobRecord&, Progress& progress) {
  CaseFolder& folder = context.folder;
  return as_stage(folder, "preview", progress, [&]() -> Result<JobOutcome> {
    LEFORT_TRY(pipeline::PreparedPreview prepared,
               pipeline::prepare_preview(preview_inputs(folder), progress));
    if (const auto etag = folder.etag(folder.preview() / "preview.json"))
      context.previews.put("preview", *etag, std::move(prepared.face));
    return reported(prepared.summary);
  });
}

/// The step of the path, from 1, that contains a path fraction.
int step_of(double path_fraction, int steps) {
  constexpr double kSame = 1e-9;  // A keyframe at 0.3333333333 is the end of step 1 of 3.
  return std::clamp(int(std::ceil(path_fraction * steps - kSame)), 1, steps);
}

json iterate_json(const predict::PredictionIterate& at, int steps) {
  const fem::NewtonIterate& line = at.line;
  return {{"step", step_of(at.to_fraction, steps)},
          {"path_fraction", at.to_fraction},
          {"attempt", at.attempt},
          {"iteration", at.iteration},
          {"residual_n", line.residual_n},
          {"relative_residual",
           line.residual_reference_n > 0.0 ? line.residual_n / line.residual_reference_n : 0.0},
          {"contact_points", line.contacts},
          {"max_penetration_increase_mm", at.deepest_mm}};
}

json step_json(int job, const predict::PredictionStep& step, int steps) {
  return {{"job", job},
          {"step", step_of(step.path_fraction, steps)},
          {"steps", steps},
          {"path_fraction", step.path_fraction},
          {"newton_iterations", step.newton_iterations()},
          {"relative_residual", step.relative_residual},
          {"contact_nodes", step.contact().nodes},
          {"p99_penetration_increase_mm", step.contact().p99_penetration_increase_mm},
          {"max_penetration_increase_mm", step.contact().max_penetration_increase_mm}};
}

Result<JobOutcome> predict_job(const JobContext& context, const JobRecord& job,
                               Progress& progress) {
  CaseFolder& folder = context.folder;
  return as_stage(folder, "prediction", progress, [&]() -> Result<JobOutcome> {
    context.history.begin(job.id);
    // The history is updated before listeners are notified.
    EventBatcher iterates([&](json batch) {
      const std::size_t from = context.history.add_iterates(batch);
      context.events.publish("newton",
                             {{"job", job.id}, {"from", from}, {"iterates", std::move(batch)}});
    });
    pipeline::PredictJob predict{
        .plan = folder.plan(),
        .ct = folder.ct(),
        .output = folder.prediction(),
        .pictures = true,
        .on_step =
            [&](const predict::PredictionStep& step, int steps) {
              iterates.flush();
              const json reported = step_json(job.id, step, steps);
              context.history.add_step(reported);
              context.events.publish("step", reported);
            },
        .on_iterate = [&](const predict::PredictionIterate& at,
                          int steps) { iterates.add(iterate_json(at, steps)); }};
    auto summary = pipeline::predict_case(predict, progress);
    iterates.flush();  // Those of a step that did not converge, too.
    if (!summary) return tl::unexpected(summary.error());
    // GET /prediction returns the whole document.
    return JobOutcome{summary->text, {{"skin", summary->json["skin"]}}};
  });
}

Result<JobOutcome> compare_job(const JobContext& context, const JobRecord& job,
                               Progress& progress) {
  CaseFolder& folder = context.folder;
  const std::string upload = job.parameters.value("upload", "");
  const auto other = context.uploads.source(upload);
  if (!other) return fail(ErrorCode::kFileNotFound, "no such upload, or the upload is empty");
  if (!there_is(folder.prediction() / "prediction.json"))
    return fail(ErrorCode::kFileNotFound, "the case has no prediction");
  const auto inputs = folder.inputs_of("comparison");
  pipeline::CompareJob compare{.face = folder.prediction(),
                               .other = {},
                               .after_ct = {},
                               .before = {},
                               .landmarks = {},
                               .output = folder.comparison(),
                               .pictures = true};
  (is_surface(other->path()) ? compare.other : compare.after_ct) = other->path();
  if (there_is(folder.landmarks())) compare.landmarks = folder.landmarks();
  LEFORT_TRY(const pipeline::Summary summary, pipeline::compare_faces(compare, progress));
  if (inputs) LEFORT_TRY_VOID(folder.record_inputs("comparison", *inputs));
  static_cast<void>(context.uploads.remove(upload));
  return reported(summary);
}

/// The document of the results names its inputs, so that they are not stored as of other stages.
Result<JobOutcome> uncertainty_job(const JobContext& context, const JobRecord& job,
                                   Progress& progress) {
  const CaseFolder& folder = context.folder;
  LEFORT_TRY_VOID(check_plan(folder));
  note_other_scans(folder, progress);
  pipeline::UncertaintyJob band{
      .plan = folder.plan(), .ct = folder.ct(), .output = folder.uncertainty()};
  band.samples = job.parameters.value("samples", band.samples);
  LEFORT_TRY(const pipeline::Summary summary, pipeline::quantify_uncertainty(band, progress));
  // GET /uncertainty returns the results.
  return JobOutcome{summary.text, {{"mean_band_mm", summary.json["mean_band_mm"]}}};
}

struct Kind {
  const char* name;
  const char* stage;  ///< That it computes; null: stage_of_splint().
  Doer run;
};

constexpr Kind kKinds[] = {{"import", "scan", import_job},
                           {"segment", "anatomy", segment_job},
                           {"landmarks", "landmarks", landmarks_job},
                           {"cut", "cut", cut_job},
                           {"check", "check", check_job},
                           {"preview-factor", "preview", preview_job},
                           {"predict", "prediction", predict_job},
                           {"compare", "comparison", compare_job},
                           {"uncertainty", "uncertainty", uncertainty_job},
                           {"teeth", "teeth", teeth_job},
                           {"arches", "arches", arches_job},
                           {"occlusion", "occlusion", occlusion_job},
                           {"splint", nullptr, splint_job},
                           {"nerve", "nerve", nerve_job},
                           {"guides", "guides", guides_job},
                           {"airway", "airway", airway_job},
                           {"cephalogram", "cephalogram", cephalogram_job},
                           {"variants", "variants", variants_job}};

}  // namespace

std::string without_paths(std::string text, const CaseFolder& folder) {
  const std::string root = folder.root().string() + "/";
  for (std::size_t at = text.find(root); at != std::string::npos; at = text.find(root, at))
    text.erase(at, root.size());
  return text;
}

pipeline::PreviewJob preview_inputs(const CaseFolder& folder) {
  return {folder.plan(), folder.ct(), folder.cache(), folder.anatomy() / "skin.vtp",
          folder.preview()};
}

std::vector<std::string> job_kinds() {
  std::vector<std::string> names;
  for (const Kind& kind : kKinds) names.emplace_back(kind.name);
  return names;
}

std::string stage_of(const JobRecord& job) {
  for (const Kind& kind : kKinds)
    if (job.kind == kind.name) return kind.stage != nullptr ? kind.stage : stage_of_splint(job);
  return "";
}

Result<JobOutcome> run_job(const JobContext& context, const JobRecord& job, Progress& progress) {
  for (const Kind& kind : kKinds) {
    if (job.kind != kind.name) continue;
    Result<JobOutcome> outcome = kind.run(context, job, progress);
    if (outcome) {
      outcome->message = without_paths(std::move(outcome->message), context.folder);
      return outcome;
    }
    return fail(outcome.error().code,
                without_paths(std::move(outcome.error().message), context.folder));
  }
  return fail(ErrorCode::kInvalidArgument, fmt::format("unknown job kind {}", job.kind));
}

}  // namespace lefort::server
