#include <lefort/geometry/triangle_mesh.h>
#include <lefort/io/landmarks_file.h>
#include <lefort/io/surface_files.h>
#include <lefort/pipeline/airway.h>
#include <lefort/pipeline/cephalogram.h>
#include <lefort/pipeline/dental.h>
#include <lefort/pipeline/guide.h>
#include <lefort/pipeline/nerve.h>
#include <lefort/server/case/file_catalog.h>
#include <lefort/server/case/job_parts.h>
#include <lefort/server/case/measure_jobs.h>
#include <lefort/server/case/measure_stages.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <initializer_list>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

namespace lefort::server {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// A text without options of the command line in parentheses, which a page does not have.
std::string without_options(std::string text) {
  constexpr std::string_view kBeginning = " (--";
  for (std::size_t at = text.find(kBeginning); at != std::string::npos;) {
    std::size_t end = at + kBeginning.size();
    while (end < text.size() &&
           (std::isalpha(static_cast<unsigned char>(text[end])) != 0 || text[end] == '-'))
      ++end;
    if (end < text.size() && text[end] == ')')
      text.erase(at, end + 1 - at);
    else
      at = end;
    at = text.find(kBeginning, at);
  }
  return text;
}

/// A summary with the words of the page in place of options of the command line.
std::string in_words_of_page(std::string text) {
  constexpr std::pair<std::string_view, std::string_view> kOptions[] = {
      {"--hole-distance", "their distance from the cut"}};
  for (const auto& [option, words] : kOptions)
    for (std::size_t at = text.find(option); at != std::string::npos; at = text.find(option, at))
      text.replace(at, option.size(), words);
  return without_options(std::move(text));
}

/// `text` with `other` in place of `part`, where it is found first.
std::string with_other(std::string text, const std::string& part, const std::string& other) {
  if (const std::size_t at = text.find(part); at != std::string::npos)
    text.replace(at, part.size(), other);
  return text;
}

/// The landmarks, if there are any. Those of another scan are noted.
std::optional<fs::path> landmarks_of(const CaseFolder& folder, Progress& progress) {
  if (!there_is(folder.landmarks())) return std::nullopt;
  if (!folder.is_of_scan("landmarks"))
    progress.note("warning: the landmarks of this case were made on another scan");
  return folder.landmarks();
}

/// Runs `work`, which writes all results or none, and stores the fingerprints of its inputs.
template <class Work>
Result<JobOutcome> as_measure(CaseFolder& folder, std::string_view stage, const Work& work) {
  LEFORT_TRY_VOID(check_scan(folder));
  const auto before = folder.inputs_of(stage);
  Result<pipeline::Summary> summary = work();
  if (!summary)
    return fail(summary.error().code, without_options(std::move(summary.error().message)));
  if (before) {
    LEFORT_TRY_VOID(folder.record_inputs(stage, inputs_read(*before, folder.inputs_of(stage))));
  }
  return JobOutcome{in_words_of_page(summary->text)};
}

Result<void> check_fresh(const CaseFolder& folder, const char* stage, const char* reason) {
  if (folder.stage(stage)["state"] == "fresh") return {};
  return fail(ErrorCode::kFileNotFound, reason);
}

/// The registered scans of both jaws.
Result<void> check_arches(const CaseFolder& folder) {
  LEFORT_TRY_VOID(check_fresh(folder, "arches",
                              "the intraoral scans are not registered, or out of date: register "
                              "them first"));
  for (const char* jaw : {"upper", "lower"})
    if (!there_is(folder.arches() / fmt::format("{}.stl", jaw)))
      return fail(ErrorCode::kFileNotFound,
                  fmt::format("the case has no intraoral scan of the {} jaw", jaw));
  return {};
}

/// An intraoral scan: one that was uploaded, or that of an earlier job.
struct ArchScan {
  const char* parameter;  ///< Of the job, that names the upload.
  std::string words;      ///< For messages.
  std::string upload;
  std::optional<Uploads::Source> source;
  geometry::TriangleMesh surface;  ///< Of `source`.
  fs::path stored;                 ///< Empty: it is not stored.

  [[nodiscard]] std::optional<fs::path> file() const {
    if (source) return source->path();
    if (there_is(stored)) return stored;
    return std::nullopt;
  }
};

/// The upload that a parameter names, if there is one.
Result<ArchScan> uploaded_scan(const JobContext& context, const JobRecord& job,
                               const char* parameter, std::string words) {
  ArchScan scan{parameter, std::move(words), job.parameters.value(parameter, ""), std::nullopt, {},
                {}};
  if (scan.upload.empty()) return scan;
  scan.source = context.uploads.source(scan.upload);
  if (!scan.source)
    return fail(ErrorCode::kFileNotFound,
                fmt::format("{}: no such upload, or the upload is empty", scan.words));
  if (!is_surface(scan.source->path()))
    return fail(
        ErrorCode::kFileUnsupported,
        fmt::format("{}: an intraoral scan is one file .stl, .ply, .obj or .vtp", scan.words));
  auto surface = io::read_surface(scan.source->path());
  if (!surface)
    return fail(surface.error().code,
                fmt::format("{}: {}", scan.words,
                            with_other(surface.error().message,
                                       scan.source->path().filename().string(), "the file")));
  scan.surface = *std::move(surface);
  return scan;
}

/// The scan of a jaw: that of the job, or of an earlier one.
Result<ArchScan> find_arch_scan(const JobContext& context, const JobRecord& job, const char* jaw) {
  LEFORT_TRY(ArchScan scan, uploaded_scan(context, job, jaw, fmt::format("{} jaw", jaw)));
  scan.stored = context.folder.scans() / fmt::format("{}.stl", jaw);
  return scan;
}

/// A message with words in place of the files of scans.
std::string naming_scans(std::string message, std::initializer_list<const ArchScan*> scans) {
  for (const ArchScan* scan : scans)
    if (const auto file = scan->file())
      message = with_other(std::move(message), file->string(), scan->words);
  return message;
}

/// Stores an uploaded scan for later jobs: the surface only, since texts in such files may name the
/// patient. Removes the results of a jaw without a scan.
Result<void> store_scan(const JobContext& context, const ArchScan& scan) {
  if (!scan.file())
    for (const char* ending : {".stl", ".tfm", "_crowns.vtp"}) {
      std::error_code error;
      fs::remove(context.folder.arches() / fmt::format("{}{}", scan.parameter, ending), error);
    }
  if (!scan.source) return {};
  std::error_code error;
  fs::create_directories(scan.stored.parent_path(), error);
  LEFORT_TRY_VOID(io::write_surface(scan.stored, scan.surface));
  static_cast<void>(context.uploads.remove(scan.upload));
  return {};
}

/// The segment of the maxilla among those of the check.
Result<fs::path> maxilla_transform(const CaseFolder& folder, const JobRecord& job) {
  std::vector<std::string> names;
  const json check = read_object(folder.check() / "check.json");
  if (const auto segments = check.find("segments"); segments != check.end())
    for (const json& one : *segments)
      if (one.is_object() && one.contains("name") && one["name"].is_string() &&
          is_segment_name(one["name"].get<std::string>()))
        names.push_back(one["name"]);
  std::string wanted = job.parameters.value("segment", "");
  if (wanted.empty() && names.size() == 1) wanted = names.front();
  if (wanted.empty()) wanted = "maxilla";
  if (std::find(names.begin(), names.end(), wanted) == names.end())
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("the plan has no segment {}: choose that of the maxilla among {}",
                            wanted, fmt::join(names, ", ")));
  return folder.check() / fmt::format("segment_{}.tfm", wanted);
}

void set_lengths(const JobRecord& job, pipeline::SplintJob& splint) {
  for (const auto& [name, value_mm] : {std::pair{"open_mm", &splint.open_mm},
                                       {"clearance_mm", &splint.options.clearance_mm},
                                       {"cover_mm", &splint.options.cover_mm},
                                       {"wall_mm", &splint.options.wall_mm},
                                       {"rim_mm", &splint.options.rim_mm},
                                       {"edge_mm", &splint.options.edge_mm},
                                       {"voxel_mm", &splint.options.voxel_mm}})
    *value_mm = job.parameters.value(name, *value_mm);
}

/// The numbers of the teeth unless they are out of date, which is noted.
std::optional<fs::path> teeth_of_occlusion(const CaseFolder& folder, Progress& progress) {
  const std::string state = folder.stage("teeth")["state"];
  if (state == "stale")
    progress.note(
        "warning: the numbers of the teeth are out of date; midlines and the relations of canines "
        "and molars are not measured");
  if (state != "fresh") return std::nullopt;
  return folder.teeth() / "teeth.json";
}

/// What the occlusion has to be. A midline needs the teeth of the job.
Result<void> set_requests(const JobRecord& job, pipeline::OcclusionJob& occlusion) {
  dental::OcclusionRequests& requests = occlusion.options.requests;
  for (const auto& [name, value_mm] : {std::pair{"midline_mm", &requests.midline_mm},
                                       {"overjet_mm", &requests.overjet_mm},
                                       {"overbite_mm", &requests.overbite_mm}})
    if (const auto found = job.parameters.find(name); found != job.parameters.end())
      *value_mm = found->get<double>();
  if (requests.midline_mm && !occlusion.teeth)
    return fail(ErrorCode::kInvalidArgument,
                "a requested midline needs the numbers of the teeth, up to date: number the teeth "
                "first");
  return {};
}

/// A message with words in place of the file of the numbered teeth.
std::string naming_teeth(std::string message, const pipeline::OcclusionJob& occlusion) {
  if (!occlusion.teeth) return message;
  const std::string file = occlusion.teeth->string();
  message = with_other(std::move(message), file + ": --midline needs", "a midline needs");
  return with_other(std::move(message), file, "numbers of the teeth");
}

/// The canals of the case unless they are out of date, which is noted.
std::optional<fs::path> nerve_of_guides(const CaseFolder& folder, Progress& progress) {
  const std::string state = folder.stage("nerve")["state"];
  if (state == "stale")
    progress.note(
        "warning: the canals of the nerves are out of date; holes are not compared with them");
  if (state != "fresh") return std::nullopt;
  return folder.nerve() / "nerve.json";
}

void set_guide_lengths(const JobRecord& job, pipeline::GuideJob& guides) {
  for (const auto& [name, value_mm] : {std::pair{"thickness_mm", &guides.guide.thickness_mm},
                                       {"width_mm", &guides.guide.width_mm},
                                       {"hole_diameter_mm", &guides.holes.diameter_mm},
                                       {"hole_distance_mm", &guides.holes.from_cut_mm}})
    *value_mm = job.parameters.value(name, *value_mm);
}

/// The landmarks of the case with the corrected points on the canals.
Result<std::optional<fs::path>> landmarks_of_nerve(const CaseFolder& folder, Progress& progress) {
  const auto landmarks = landmarks_of(folder, progress);
  const auto points = nerve_points(folder);
  if (!points) return landmarks;
  LEFORT_TRY(plan::Landmarks all, io::read_landmarks(*points));
  if (landmarks) {
    LEFORT_TRY(const plan::Landmarks others, io::read_landmarks(*landmarks));
    for (const plan::Landmark& one : others)
      if (!plan::find_landmark(all, one.name)) all.push_back(one);
  }
  std::error_code error;
  fs::create_directories(folder.nerve(), error);
  fs::path file = folder.nerve() / "landmarks_and_points.mrk.json";
  LEFORT_TRY_VOID(io::write_landmarks(file, all));
  return std::optional(std::move(file));
}

/// Adds check and prediction where they are fresh. Landmarks after surgery are compared with those
/// of the plan, which may be others than those of the case.
void add_results_of_plan(const CaseFolder& folder, pipeline::CephalogramJob& job,
                         Progress& progress) {
  const json plan = read_object(folder.plan());
  const bool is_auto = plan.contains("landmarks") && plan["landmarks"] == "auto";
  if (folder.stage("prediction")["state"] == "fresh") {
    job.prediction = folder.prediction();
    if (is_auto) job.landmarks.reset();
  }
  if (folder.stage("check")["state"] != "fresh") return;
  if (job.prediction || (job.landmarks && !is_auto))
    job.check = folder.check();
  else
    progress.note("the check of the plan is not drawn: the case does not have its landmarks");
}

}  // namespace

std::string stage_of_splint(const JobRecord& job) {
  const json& parameters = job.parameters;
  const bool is_intermediate = parameters.is_object() && parameters.contains("splint") &&
                               parameters["splint"] == "intermediate";
  return is_intermediate ? "splint_intermediate" : "splint_final";
}

Result<JobOutcome> teeth_job(const JobContext& context, const JobRecord&, Progress& progress) {
  CaseFolder& folder = context.folder;
  return as_measure(folder, "teeth", [&]() -> Result<pipeline::Summary> {
    pipeline::TeethJob teeth;
    teeth.ct = folder.ct();
    teeth.labels = labels_of_scan(folder);
    teeth.landmarks = landmarks_of(folder, progress);
    teeth.output = folder.teeth();
    const auto corrections = tooth_corrections(folder);
    teeth.corrections = corrections;
    auto summary = pipeline::number_teeth_of_scan(teeth, progress);
    std::error_code error;
    if (summary && !corrections) fs::remove(folder.teeth() / "teeth_corrections.json", error);
    return summary;
  });
}

Result<JobOutcome> arches_job(const JobContext& context, const JobRecord& job, Progress& progress) {
  CaseFolder& folder = context.folder;
  return as_measure(folder, "arches", [&]() -> Result<pipeline::Summary> {
    LEFORT_TRY(const ArchScan upper, find_arch_scan(context, job, "upper"));
    LEFORT_TRY(const ArchScan lower, find_arch_scan(context, job, "lower"));
    if (!upper.file() && !lower.file())
      return fail(ErrorCode::kInvalidArgument,
                  "no intraoral scan: choose one of the upper or the lower jaw");
    pipeline::RegisterArchesJob arches;
    arches.ct = folder.ct();
    arches.labels = labels_of_scan(folder);
    arches.upper = upper.file();
    arches.lower = lower.file();
    arches.output = folder.arches();
    auto summary = pipeline::register_arches(arches, progress);
    if (!summary)
      return fail(summary.error().code, naming_scans(summary.error().message, {&upper, &lower}));
    for (const ArchScan* scan : {&upper, &lower}) {
      LEFORT_TRY_VOID(store_scan(context, *scan));
    }
    return summary;
  });
}

Result<JobOutcome> occlusion_job(const JobContext& context, const JobRecord& job,
                                 Progress& progress) {
  CaseFolder& folder = context.folder;
  return as_measure(folder, "occlusion", [&]() -> Result<pipeline::Summary> {
    LEFORT_TRY_VOID(check_arches(folder));
    LEFORT_TRY(const ArchScan first, uploaded_scan(context, job, "bite", "bite scan"));
    LEFORT_TRY(const ArchScan second, uploaded_scan(context, job, "bite2", "second bite scan"));
    pipeline::OcclusionJob occlusion;
    occlusion.upper = folder.arches() / "upper.stl";
    occlusion.lower = folder.arches() / "lower.stl";
    occlusion.arches = folder.arches() / "arches.json";
    occlusion.output = folder.occlusion();
    occlusion.is_as_scanned = job.parameters.value("source", "search") == "as_scanned";
    occlusion.teeth = teeth_of_occlusion(folder, progress);
    LEFORT_TRY_VOID(set_requests(job, occlusion));
    for (const ArchScan* bite : {&first, &second})
      if (bite->source) occlusion.bites.push_back(bite->source->path());
    auto summary = pipeline::find_arch_occlusion(occlusion, progress);
    if (!summary)
      return fail(
          summary.error().code,
          naming_teeth(naming_scans(summary.error().message, {&first, &second}), occlusion));
    for (const ArchScan* bite : {&first, &second})
      if (bite->source) static_cast<void>(context.uploads.remove(bite->upload));
    return summary;
  });
}

Result<JobOutcome> splint_job(const JobContext& context, const JobRecord& job, Progress& progress) {
  CaseFolder& folder = context.folder;
  const std::string stage = stage_of_splint(job);
  return as_measure(folder, stage, [&]() -> Result<pipeline::Summary> {
    LEFORT_TRY_VOID(check_arches(folder));
    pipeline::SplintJob splint;
    splint.upper = folder.arches() / "upper.stl";
    splint.lower = folder.arches() / "lower.stl";
    splint.arches = folder.arches() / "arches.json";
    splint.output = folder_of_measure(folder, stage);
    set_lengths(job, splint);
    splint.text = job.parameters.value("text", "");
    if (stage == "splint_final") {
      LEFORT_TRY_VOID(check_fresh(folder, "occlusion",
                                  "the occlusion is not found, or out of date: find it first"));
      splint.lower = folder.occlusion() / "lower.stl";
    } else {
      LEFORT_TRY_VOID(check_fresh(folder, "check",
                                  "the plan is not checked, or its check is out of date: check it "
                                  "first"));
      LEFORT_TRY(splint.upper_transform, maxilla_transform(folder, job));
    }
    return pipeline::make_arch_splint(splint, progress);
  });
}

Result<JobOutcome> nerve_job(const JobContext& context, const JobRecord&, Progress& progress) {
  CaseFolder& folder = context.folder;
  return as_measure(folder, "nerve", [&]() -> Result<pipeline::Summary> {
    pipeline::NerveJob nerve;
    nerve.ct = folder.ct();
    nerve.labels = labels_of_scan(folder);
    nerve.output = folder.nerve();
    LEFORT_TRY(nerve.landmarks, landmarks_of_nerve(folder, progress));
    return pipeline::trace_nerves(nerve, progress);
  });
}

Result<JobOutcome> guides_job(const JobContext& context, const JobRecord& job, Progress& progress) {
  CaseFolder& folder = context.folder;
  return as_measure(folder, "guides", [&]() -> Result<pipeline::Summary> {
    LEFORT_TRY_VOID(check_plan(folder));
    note_other_scans(folder, progress);
    pipeline::GuideJob guides;
    guides.plan = folder.plan();
    guides.ct = folder.ct();
    guides.nerve = nerve_of_guides(folder, progress);
    guides.tooth_corrections = tooth_corrections(folder);
    guides.segment = job.parameters.value("segment", "");
    guides.from = job.parameters.value("from", "");
    set_guide_lengths(job, guides);
    guides.cache = folder.cache();
    guides.output = folder.guides();
    return pipeline::make_guides(guides, progress);
  });
}

Result<JobOutcome> airway_job(const JobContext& context, const JobRecord&, Progress& progress) {
  CaseFolder& folder = context.folder;
  return as_measure(folder, "airway", [&] {
    pipeline::AirwayJob airway;
    airway.ct = folder.ct();
    airway.labels = labels_of_scan(folder);
    airway.landmarks = landmarks_of(folder, progress);
    airway.output = folder.airway();
    if (folder.stage("prediction")["state"] == "fresh") airway.prediction = folder.prediction();
    return pipeline::measure_airway_of_scan(airway, progress);
  });
}

Result<JobOutcome> cephalogram_job(const JobContext& context, const JobRecord& job,
                                   Progress& progress) {
  CaseFolder& folder = context.folder;
  return as_measure(folder, "cephalogram", [&] {
    pipeline::CephalogramJob cephalogram;
    cephalogram.ct = folder.ct();
    cephalogram.labels = labels_of_scan(folder);
    cephalogram.landmarks = landmarks_of(folder, progress);
    cephalogram.output = folder.cephalogram();
    if (job.parameters.value("norms", "female") == "male") cephalogram.sex = plan::Sex::kMale;
    add_results_of_plan(folder, cephalogram, progress);
    return pipeline::make_cephalogram(cephalogram, progress);
  });
}

}  // namespace lefort::server
