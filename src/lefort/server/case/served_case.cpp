#include <lefort/io/import_volume.h>
#include <lefort/io/preview_file.h>
#include <lefort/server/case/case_jobs.h>
#include <lefort/server/case/served_case.h>

#include <utility>
#include <vector>

namespace lefort::server {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::size_t kKeptSurfaces = 24;  // Eight, and those of 16 segments.

}  // namespace

ServedCase::ServedCase(CaseFolder folder_of, std::optional<fs::path> example_of,
                       UploadLimits upload_limits)
    : folder(std::move(folder_of)),
      uploads(folder.uploads(), upload_limits),
      example(std::move(example_of)),
      events(random_hex(8)),
      cached_volume(1),
      cached_bones(1),
      cached_preview(1),
      step_skins(1),
      cached_surfaces(kKeptSurfaces),
      jobs(
          folder.jobs(), events,
          [this](const JobRecord& job, Progress& progress) {
            auto outcome =
                run_job({folder, uploads, events, solve_history, example}, job, progress);
            if (outcome && job.kind == "preview-factor") warm_preview();
            return outcome;
          },
          [this] { report_stages(); }) {}

json ServedCase::stages() const {
  json stages = json::object();
  for (const char* name : kStages) {
    json stage = folder.stage(name);
    const std::string kind = job_of_stage(name);
    if (const auto job = kind.empty() ? std::nullopt : jobs.last_of(kind)) {
      if (job->state == "running") {
        stage["state"] = "running";
        stage["why"] = "";
      } else if (stage["state"] == "missing" && job->state == "failed") {
        stage["state"] = "failed";
        stage["why"] = job->message;
      } else if (stage["state"] == "missing" && job->state != "done" && job->is_over()) {
        stage["why"] = job->message;
      }
    }
    stages[name] = std::move(stage);
  }
  return stages;
}

void ServedCase::report_stages() { events.publish("case", {{"stages", stages()}}); }

Result<std::shared_ptr<const image::CtVolume>> ServedCase::volume() {
  const auto etag = folder.etag(folder.ct());
  if (!etag) return fail(ErrorCode::kFileNotFound, "the case has no scan: import one first");
  return cached_volume.get("ct", *etag, [&]() -> Result<image::CtVolume> {
    LEFORT_TRY(io::ImportedVolume scan, io::import_volume(folder.ct()));
    return std::move(scan.ct);
  });
}

Result<std::shared_ptr<const predict::FacePreview>> ServedCase::preview() {
  // Keyed by the model: preview.json is the same for other materials.
  const auto etag = folder.etag(folder.preview() / "face.preview");
  if (!etag || !there_is(folder.preview() / "preview.json"))
    return fail(ErrorCode::kFileNotFound, "no preview is prepared");
  return cached_preview.get("preview", *etag, [&]() -> Result<predict::FacePreview> {
    LEFORT_TRY(predict::PreviewModel model,
               io::read_preview_model(folder.preview() / "face.preview"));
    return predict::FacePreview(std::move(model));
  });
}

void ServedCase::warm_preview() {
  RigidTransform little = RigidTransform::Identity();
  little.translation().y() = -1.0;
  // An error is reported by the first request for a preview.
  if (const auto face = preview())
    static_cast<void>(
        (*face)->displacement_mm(std::vector<RigidTransform>((*face)->segment_count(), little)));
}

}  // namespace lefort::server
