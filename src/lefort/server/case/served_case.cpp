#include <lefort/io/import_volume.h>
#include <lefort/pipeline/preview.h>
#include <lefort/server/case/case_jobs.h>
#include <lefort/server/case/served_case.h>

#include <utility>
#include <vector>

namespace lefort::server {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::size_t kKeptSurfaces = 36;  // 16, those of 16 segments, and of 4 variants.

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
            return run_job({folder, uploads, events, solve_history, cached_preview, example}, job,
                           progress);
          },
          [this] { report_stages(); }) {}

json ServedCase::stages() const {
  json stages = json::object();
  for (const char* name : kStages) {
    json stage = folder.stage(name);
    const auto computes = [&](const JobRecord& job) { return stage_of(job) == name; };
    if (const auto job = jobs.last_of(computes)) {
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
  const auto etag = folder.etag(folder.preview() / "preview.json");
  if (!etag) return fail(ErrorCode::kFileNotFound, "no preview is prepared");
  const auto is_fresh = [&] { return folder.stage("preview")["state"] == "fresh"; };
  return cached_preview.get("preview", *etag, [&]() -> Result<predict::FacePreview> {
    const char* const stale = "the preview is of an earlier server: run the job preview-factor";
    if (!is_fresh()) return fail(ErrorCode::kFileNotFound, stale);
    auto face = pipeline::load_preview(preview_inputs(folder), Progress::none());
    if (!face) return fail(face.error().code, without_paths(face.error().message, folder));
    if (!is_fresh()) return fail(ErrorCode::kFileNotFound, stale);
    return face;
  });
}

}  // namespace lefort::server
